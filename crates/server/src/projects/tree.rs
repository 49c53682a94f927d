//! The tree of a project: folders and machines. Knows folders and the name of a machine's header; reads no machine.
//!
//! Links are not followed: a target inside the project is listed at its own position. A large tree is listed level by level, so
//! that folders near the root come before deeply nested ones.

use rafcon_protocol::api::{FileNode, NodeKind};
use rafcon_storage::files::HEADER;
use std::path::{Path, PathBuf};
use std::{fs, io};

/// Limits on the size of a tree.
#[derive(Debug, Clone, Copy)]
pub(super) struct TreeLimits {
    /// Maximum number of folders and machines.
    pub(super) nodes: usize,
    /// Maximum number of levels.
    pub(super) depth: usize,
}

/// Limits of one response.
pub(super) const BOUNDS: TreeLimits = TreeLimits { nodes: 10_000, depth: 32 };

/// Folders that belong to other programs.
const FOREIGN: [&str; 3] = ["__pycache__", "node_modules", "target"];

/// A folder before it is moved into its parent.
struct ListedFolder {
    node: FileNode,
    folder: PathBuf,
    depth: usize,
    parent: usize,
}

/// True if the name is hidden, or made by another program for itself.
pub(crate) fn is_foreign(name: &str) -> bool {
    name.starts_with('.') || FOREIGN.contains(&name)
}

/// True if the folder has a machine's header. The header may be a link, as in an installed workspace.
pub(crate) fn is_machine(folder: &Path) -> bool {
    folder.join(HEADER).is_file()
}

/// The tree below `folder`, which is `path` in its project, without the folders in `hidden`.
pub(super) fn tree(folder: &Path, path: &str, hidden: &[&Path], bounds: TreeLimits) -> FileNode {
    let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mut found = vec![found(name, path.to_owned(), folder.to_owned(), 0, 0)];
    let mut at = 0;
    while at < found.len() {
        let children = children(&found[at], at, hidden);
        let room = bounds.nodes.saturating_sub(found.len());
        let is_cut =
            children.len() > room || (!children.is_empty() && found[at].depth >= bounds.depth);
        found[at].node.is_cut = is_cut;
        if !is_cut {
            found.extend(children);
        }
        at += 1;
    }
    assembled(found)
}

/// The folders in a folder, sorted by name. An unreadable folder counts as empty.
fn children(of: &ListedFolder, parent: usize, hidden: &[&Path]) -> Vec<ListedFolder> {
    if of.node.kind == NodeKind::Machine {
        return Vec::new();
    }
    let mut names = names(&of.folder).unwrap_or_default();
    names.sort();
    let child = |name: String| {
        let path =
            if of.node.path.is_empty() { name.clone() } else { format!("{}/{name}", of.node.path) };
        found(name.clone(), path, of.folder.join(name), of.depth + 1, parent)
    };
    let is_shown = |found: &ListedFolder| !hidden.contains(&found.folder.as_path());
    names.into_iter().map(child).filter(is_shown).collect()
}

fn names(folder: &Path) -> io::Result<Vec<String>> {
    let mut names = Vec::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let Ok(name) = entry.file_name().into_string() else { continue };
        if !is_foreign(&name) && entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            names.push(name);
        }
    }
    Ok(names)
}

fn found(name: String, path: String, folder: PathBuf, depth: usize, parent: usize) -> ListedFolder {
    let kind = if is_machine(&folder) { NodeKind::Machine } else { NodeKind::Folder };
    let node = FileNode { name, path, kind, children: Vec::new(), is_cut: false };
    ListedFolder { node, folder, depth, parent }
}

/// Moves every node into its parent, which precedes it. The first node is the root.
fn assembled(mut found: Vec<ListedFolder>) -> FileNode {
    while found.len() > 1 {
        let Some(ListedFolder { mut node, parent, .. }) = found.pop() else { break };
        node.children.reverse();
        found[parent].node.children.push(node);
    }
    let mut root = found.swap_remove(0).node;
    root.children.reverse();
    root
}

#[cfg(test)]
mod tests {
    use super::*;
    use expect_test::{Expect, expect};
    use std::fmt::Write as _;
    use std::os::unix::fs::symlink;

    /// A project of folders; a trailing `!` marks a machine.
    fn project(paths: &[&str]) -> tempfile::TempDir {
        let project = tempfile::tempdir().unwrap();
        for path in paths {
            let folder = project.path().join(path.trim_end_matches('!'));
            fs::create_dir_all(&folder).unwrap();
            if path.ends_with('!') {
                fs::write(folder.join(HEADER), "{}").unwrap();
            }
        }
        project
    }

    fn check(project: &Path, hidden: &str, bounds: TreeLimits, expected: &Expect) {
        let mut text = String::new();
        let hidden = project.join(hidden);
        for child in tree(project, "", &[&hidden], bounds).children {
            draw(&child, 0, &mut text);
        }
        expected.assert_eq(&text);
    }

    fn draw(node: &FileNode, depth: usize, text: &mut String) {
        let kind = if node.kind == NodeKind::Machine { "!" } else { "" };
        let cut = if node.is_cut { " …" } else { "" };
        let name = if node.path.ends_with(&node.name) { &node.path } else { "?" };
        writeln!(text, "{:depth$}{name}{kind}{cut}", "").unwrap();
        for child in &node.children {
            draw(child, depth + 1, text);
        }
    }

    #[test]
    fn folders_and_machines_are_told_but_nothing_inside_a_machine() {
        let project =
            project(&["b/two!", "b/one!/STATE", "a", ".git/x", "lib/__pycache__", "runs/1"]);
        fs::write(project.path().join("notes.txt"), "").unwrap();
        check(
            project.path(),
            "runs",
            BOUNDS,
            &expect![[r"
                a
                b
                 b/one!
                  b/one!/STATE
                 b/two!
                lib
            "]],
        );
    }

    #[test]
    fn links_are_not_followed() {
        let project = project(&["b/one!"]);
        symlink("..", project.path().join("b/up")).unwrap();
        symlink("/", project.path().join("root")).unwrap();
        check(
            project.path(),
            "",
            BOUNDS,
            &expect![[r"
            b
             b/one!
        "]],
        );
    }

    #[test]
    fn what_is_large_is_cut_far_from_the_top_first() {
        let project = project(&["a/x/1", "a/x/2", "a/y/1", "b/z/1"]);
        check(
            project.path(),
            "",
            TreeLimits { nodes: 6, depth: 9 },
            &expect![[r"
            a
             a/x …
             a/y …
            b
             b/z …
        "]],
        );
        check(
            project.path(),
            "",
            TreeLimits { nodes: 99, depth: 1 },
            &expect![[r"
            a …
            b …
        "]],
        );
    }
}
