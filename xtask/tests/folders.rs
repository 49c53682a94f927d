//! The order of the folders inside a module: a file imports from its own folder and from lower ones, so that no folder knows
//! another that knows it.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// A module whose folders have an order. Every file below it but its own one and tests lies in one of them, or is one of them.
struct Module {
    /// Where it lies, from `crates`.
    source: &'static str,
    /// Its own file there.
    own_file: &'static str,
    /// How paths into it begin.
    root: &'static str,
    /// Its folders, and files that are modules by themselves, the lowest first.
    order: &'static [&'static str],
    /// The file that puts the parts together: it may import all, and all may import it.
    whole: Option<&'static str>,
}

const MODULES: [Module; 5] = [
    Module {
        source: "runner/src",
        own_file: "lib.rs",
        root: "crate::",
        order: &["places", "record", "drive", "viewers", "life"],
        whole: None,
    },
    Module {
        source: "engine/src/engine",
        own_file: "mod.rs",
        root: "crate::engine::",
        order: &["state", "stepping", "backward", "commands", "changes", "life"],
        whole: None,
    },
    Module {
        source: "storage/src",
        own_file: "lib.rs",
        root: "crate::",
        order: &[
            "remedy",
            "config",
            "files",
            "problem",
            "journal",
            "staging",
            "read",
            "whereabouts",
            "write",
            "packer",
        ],
        whole: None,
    },
    Module {
        source: "storage/src/journal",
        own_file: "mod.rs",
        root: "crate::journal::",
        order: &[
            "folder",
            "record",
            "moment",
            "store",
            "read",
            "stream",
            "compare",
            "export",
            "pack",
            "write",
            "replicate",
        ],
        whole: None,
    },
    Module {
        source: "server/src",
        own_file: "lib.rs",
        root: "crate::",
        order: &[
            "log",
            "failure",
            "child",
            "change_counters",
            "document_text",
            "page_files",
            "settings",
            "gate",
            "extract",
            "access",
            "projects",
            "watch",
            "python",
            "documents",
            "plans",
            "history",
            "runs",
            "socket",
            "page",
            "description",
            "router",
            "listen",
        ],
        whole: Some("state"),
    },
];

#[test]
fn a_file_imports_from_its_own_folder_and_lower_ones() {
    let mut found = Vec::new();
    for module in &MODULES {
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates").join(module.source);
        let own_file = source.join(module.own_file);
        let own_text = fs::read_to_string(&own_file).expect("a module has its own file");
        let folder_of = exported(&own_text, module.order);
        for file in files(&source).iter().filter(|file| **file != own_file) {
            let name = file.strip_prefix(&source).expect("it lies there").display().to_string();
            let text = fs::read_to_string(file).expect("a source is text");
            found.extend(faults(&name, &text, module, &folder_of));
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn an_import_upwards_is_found() {
    let order = &["low", "high"];
    let whole = Some("whole");
    let module = Module { source: "", own_file: "lib.rs", root: "crate::", order, whole };
    let folder_of = exported("pub use high::door::{Door, open};\npub use low::Floor;\n", order);
    let check = |text| faults("low/a.rs", text, &module, &folder_of).concat();
    assert_eq!(check("use crate::low::b;\nuse crate::{Floor, low::c};\n"), "");
    assert_eq!(check("use crate::high::b;\n"), "low/a.rs imports from high, which is above it");
    assert_eq!(
        check("use crate::{Floor, Door};\n"),
        "low/a.rs imports from high, which is above it"
    );
    assert_eq!(
        faults("low.rs", "use crate::high::b;", &module, &folder_of),
        ["low.rs imports from high, which is above it"]
    );
    assert_eq!(check("#[cfg(test)]\nmod tests { use crate::high::b; }\n"), "");
    assert_eq!(
        faults("b.rs", "", &module, &folder_of),
        ["b.rs lies in none of the folders low, high"]
    );
    assert_eq!(check("use crate::whole::Whole;\n"), "");
    assert!(faults("whole.rs", "use crate::high::b;", &module, &folder_of).is_empty());
}

/// What is wrong with one file.
fn faults(
    file: &str,
    text: &str,
    module: &Module,
    folder_of: &BTreeMap<String, String>,
) -> Vec<String> {
    let folder = file.split('/').next().unwrap_or_default().trim_end_matches(".rs");
    let order = module.order;
    if module.whole == Some(folder) {
        return Vec::new();
    }
    let Some(height) = order.iter().position(|known| *known == folder) else {
        return vec![format!("{file} lies in none of the folders {}", order.join(", "))];
    };
    let mut above: Vec<&str> = imported(text, module.root)
        .into_iter()
        .filter_map(|name| folder_of.get(name).map(String::as_str))
        .filter(|folder| order.iter().position(|known| known == folder) > Some(height))
        .collect();
    above.sort_unstable();
    above.dedup();
    let fault = |above| format!("{file} imports from {above}, which is above it");
    above.into_iter().map(fault).collect()
}

/// In which folder each name lies that the module has: the folders, and what its own file exports from them.
fn exported(library: &str, order: &[&str]) -> BTreeMap<String, String> {
    let mut names: BTreeMap<String, String> =
        order.iter().map(|folder| ((*folder).to_owned(), (*folder).to_owned())).collect();
    for item in library.split("pub use ").skip(1) {
        let path = item.split(';').next().unwrap_or_default();
        let folder = path.split("::").next().unwrap_or_default();
        let words = path.split(|c: char| !c.is_alphanumeric() && c != '_');
        for word in words.filter(|word| !word.is_empty() && order.contains(&folder)) {
            names.entry(word.to_owned()).or_insert_with(|| folder.to_owned());
        }
    }
    names
}

/// The first names of all paths that begin at the module's root, but for tests.
fn imported<'t>(text: &'t str, root: &str) -> Vec<&'t str> {
    let production = text.split("#[cfg(test)]").next().unwrap_or_default();
    let paths = production.match_indices(root).filter(|(at, _)| !is_comment(production, *at));
    paths.flat_map(|(at, root)| first_names(&production[at + root.len()..])).collect()
}

fn is_comment(text: &str, at: usize) -> bool {
    text[..at].rsplit('\n').next().is_some_and(|line| line.trim_start().starts_with("//"))
}

/// The first name of a path, or those of a group.
fn first_names(path: &str) -> Vec<&str> {
    let Some(group) = path.strip_prefix('{') else { return vec![word(path)] };
    let (mut names, mut depth, mut start) = (Vec::new(), 0, 0);
    for (at, letter) in group.char_indices() {
        match letter {
            '{' => depth += 1,
            '}' if depth == 0 => {
                names.push(word(&group[start..at]));
                break;
            }
            '}' => depth -= 1,
            ',' if depth == 0 => {
                names.push(word(&group[start..at]));
                start = at + 1;
            }
            _ => {}
        }
    }
    names
}

fn word(text: &str) -> &str {
    let text = text.trim_start();
    let end = text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len());
    &text[..end]
}

/// The files of the product below a folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder can be read") {
        let path = entry.expect("an entry can be read").path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_dir() {
            if name != "tests" {
                found.extend(files(&path));
            }
        } else if path.extension().is_some_and(|end| end == "rs") && name != "tests.rs" {
            found.push(path);
        }
    }
    found
}
