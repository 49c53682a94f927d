//! Resolves the path of a request to a folder in its project, or refuses it. Knows file systems; reads no file.
//!
//! All links are resolved here, once, so the returned path contains none: a link that existed at the request cannot redirect later
//! operations.

use super::tree::is_machine;
use crate::Failure;
use std::ffi::OsStr;
use std::io::ErrorKind;
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};
use std::{fs, io};

/// Limit on the length of a path, in bytes, checked before any access to the disk.
const LONGEST: usize = 4096;

/// The folder `path`, segments joined by `/`, below `project`. An empty path means the project. The folder need not exist.
pub(super) fn below(project: &Path, path: &str) -> Result<PathBuf, Failure> {
    let segments = segments(path)?;
    let home = fs::canonicalize(project).map_err(|error| unreachable(path, &error))?;
    let (there, missing) = deepest(&home, &segments).map_err(|error| unreachable(path, &error))?;
    if !there.starts_with(&home) {
        let message = format!(
            "`{path}` leads out of its project by a link: use the project in which the folder really lies"
        );
        return Err(Failure::forbidden("outside_project", message));
    }
    Ok(missing.iter().fold(there, |folder, name| folder.join(name)))
}

/// The folder of the machine that `path` names, either by its folder or by a file in it.
pub(super) fn machine(project: &Path, path: &str) -> Result<PathBuf, Failure> {
    if let Some((file, folder)) = segments(path)?.split_last() {
        let folder = below(project, &folder.join("/"))?;
        // A file that is a link still belongs to the machine in its folder.
        if is_machine(&folder) && folder.join(file).is_file() {
            return Ok(folder);
        }
    }
    below(project, path)
}

/// The segments of a path, each a valid name.
fn segments(path: &str) -> Result<Vec<&str>, Failure> {
    let names = path.split('/').filter(|name| !matches!(*name, "" | ".")).collect::<Vec<_>>();
    // Programs use hidden folders such as `.git` for themselves.
    let is_name = |name: &&str| !name.starts_with('.') && !name.contains('\0');
    if path.len() <= LONGEST && !path.starts_with('/') && names.iter().all(is_name) {
        return Ok(names);
    }
    let shown = path.chars().take(100).collect::<String>().escape_debug().to_string();
    let message = format!(
        "`{shown}` is not a path in a project: names joined by `/`, none of them hidden (with a dot in front), \
         no `/` at the beginning, {LONGEST} bytes at most"
    );
    Err(Failure::bad("bad_path", message))
}

/// The deepest existing folder on the path, with links resolved, and the missing names below it.
fn deepest<'s>(home: &Path, segments: &'s [&'s str]) -> io::Result<(PathBuf, &'s [&'s str])> {
    let mut folder = home.to_owned();
    for (at, name) in segments.iter().enumerate() {
        let next = folder.join(OsStr::new(name));
        match next.symlink_metadata() {
            Ok(_) => folder = as_listed(fs::canonicalize(&next)?, is_same),
            Err(error) if error.kind() == ErrorKind::NotFound => {
                return Ok((folder, &segments[at..]));
            }
            Err(error) => return Err(error),
        }
        if !folder.starts_with(home) {
            return Ok((folder, &[]));
        }
    }
    Ok((folder, &[]))
}

/// The folder with the case that its parent lists. Some file systems ignore case.
fn as_listed(folder: PathBuf, is_same: impl Fn(&Path, &Path) -> bool) -> PathBuf {
    let Some((parent, name)) = folder.parent().zip(folder.file_name().and_then(OsStr::to_str))
    else {
        return folder;
    };
    let swap =
        |c: char| if c.is_lowercase() { c.to_ascii_uppercase() } else { c.to_ascii_lowercase() };
    let other = name.chars().map(swap).collect::<String>();
    if other == name || !is_same(&parent.join(other), &folder) {
        return folder;
    }
    let names = fs::read_dir(parent).into_iter().flatten().flatten().map(|entry| entry.file_name());
    let mut alike = names.filter(|listed| listed.eq_ignore_ascii_case(name));
    alike
        .find(|listed| is_same(&parent.join(listed), &folder))
        .map_or(folder.clone(), |listed| parent.join(listed))
}

fn is_same(one: &Path, other: &Path) -> bool {
    let about = |path: &Path| path.metadata().map(|about| (about.dev(), about.ino()));
    matches!((about(one), about(other)), (Ok(one), Ok(other)) if one == other)
}

fn unreachable(path: &str, error: &io::Error) -> Failure {
    let message =
        format!("`{path}` cannot be reached: {error}; correct the path or what lies there");
    match error.kind() {
        ErrorKind::PermissionDenied => Failure::forbidden("unreadable", message),
        ErrorKind::NotFound => Failure::not_found("no_such_folder", message),
        _ => Failure::bad("bad_path", message),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use expect_test::{Expect, expect};
    use std::os::unix::fs::symlink;

    /// A project with folders, links inside and to the outside, and a file. Also returns its folder.
    fn project() -> (tempfile::TempDir, PathBuf) {
        let place = tempfile::tempdir().unwrap();
        let home = place.path().canonicalize().unwrap().join("project");
        fs::create_dir_all(home.join("machines/one")).unwrap();
        fs::create_dir_all(place.path().join("outside/secret")).unwrap();
        fs::write(home.join("file"), "").unwrap();
        let link = |to: &str, name: &str| symlink(to, home.join(name)).unwrap();
        link("../outside", "out");
        link("machines", "inside");
        link("nowhere", "dangling");
        link("../outside/new", "dangling_out");
        link("round", "round");
        (place, home)
    }

    fn check(path: &str, expected: &Expect) {
        let (_place, home) = project();
        let shown = match below(&home, path) {
            Ok(found) => format!("./{}", found.strip_prefix(&home).unwrap().display()),
            Err(failure) => format!("{} {}", failure.status(), failure.refusal().code),
        };
        expected.assert_eq(&shown);
    }

    #[test]
    fn a_folder_in_the_project_is_found() {
        check("", &expect!["./"]);
        check("machines/one", &expect!["./machines/one"]);
        check("machines/new/deeper", &expect!["./machines/new/deeper"]);
        check("inside/one", &expect!["./machines/one"]);
        check("inside/new", &expect!["./machines/new"]);
    }

    #[test]
    fn several_spellings_name_one_folder() {
        for path in ["machines/one/", "./machines/one", "machines/./one/.", "machines//one"] {
            check(path, &expect!["./machines/one"]);
        }
        check(".", &expect!["./"]);
    }

    #[test]
    fn a_name_in_another_case_is_spelled_as_it_is_listed() {
        let place = tempfile::tempdir().unwrap();
        for name in ["Hello", "other", "42"] {
            fs::create_dir(place.path().join(name)).unwrap();
        }
        let any_case =
            |one: &Path, other: &Path| one.as_os_str().eq_ignore_ascii_case(other.as_os_str());
        let listed = |name: &str| as_listed(place.path().join(name), any_case);
        assert_eq!(listed("hELLO"), place.path().join("Hello"));
        assert_eq!(listed("Hello"), place.path().join("Hello"));
        assert_eq!(listed("42"), place.path().join("42"));
        let exact = as_listed(place.path().join("other"), is_same);
        assert_eq!(exact, place.path().join("other"));
    }

    #[test]
    fn no_path_leads_out_of_the_project() {
        for path in ["..", "../outside", "machines/../../outside", "machines/.."] {
            check(path, &expect!["400 Bad Request bad_path"]);
        }
        for path in ["/etc", "//etc", "/", "a\0b"] {
            check(path, &expect!["400 Bad Request bad_path"]);
        }
        check(&"a/".repeat(5000), &expect!["400 Bad Request bad_path"]);
    }

    #[test]
    fn hidden_folders_are_for_the_programs_whose_they_are() {
        for path in [".git", ".git/hooks", "machines/.git", "machines/one/.hidden/two"] {
            check(path, &expect!["400 Bad Request bad_path"]);
        }
    }

    #[test]
    fn no_link_leads_out_of_the_project() {
        for path in ["out", "out/secret", "out/new", "out/secret/new"] {
            check(path, &expect!["403 Forbidden outside_project"]);
        }
    }

    #[test]
    fn links_to_nothing_are_no_place_for_a_new_folder() {
        for path in ["dangling", "dangling/new", "dangling_out", "dangling_out/new"] {
            check(path, &expect!["404 Not Found no_such_folder"]);
        }
        check("round", &expect!["400 Bad Request bad_path"]);
    }

    #[test]
    fn what_lies_in_the_way_is_named() {
        check("file/new", &expect!["400 Bad Request bad_path"]);
        check(&"n".repeat(300), &expect!["400 Bad Request bad_path"]);
    }
}
