//! From the path in a request to a folder that lies in its project, or a refusal. Knows file systems; reads no file.
//!
//! Every link is followed here, once, and what is handed out has none: what is done with it later cannot be led
//! elsewhere by a link that was there when the request came.

use crate::Failure;
use std::ffi::OsStr;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::{fs, io};

/// Longer paths are refused before anything is looked up.
const LONGEST: usize = 4096;

/// The folder `path`, segments joined by `/`, below `project`; empty for `project` itself. It need not exist.
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

/// The names that a path consists of, each of them one that a folder can have.
fn segments(path: &str) -> Result<Vec<&str>, Failure> {
    let names = path.split('/').filter(|_| !path.is_empty()).collect::<Vec<_>>();
    // Programs keep their own files in hidden folders, such as `.git`.
    let is_name = |name: &&str| !name.is_empty() && !name.starts_with('.') && !name.contains('\0');
    if path.len() <= LONGEST && names.iter().all(is_name) {
        return Ok(names);
    }
    let shown = path.chars().take(100).collect::<String>().escape_debug().to_string();
    let message = format!(
        "`{shown}` is not a path in a project: names joined by `/`, none of them empty or hidden (with a dot in front), \
         no `/` at the beginning, {LONGEST} bytes at most"
    );
    Err(Failure::bad("bad_path", message))
}

/// The deepest folder on the way that exists, links followed, and the names that are missing below it.
fn deepest<'s>(home: &Path, segments: &'s [&'s str]) -> io::Result<(PathBuf, &'s [&'s str])> {
    let mut folder = home.to_owned();
    for (at, name) in segments.iter().enumerate() {
        let next = folder.join(OsStr::new(name));
        match next.symlink_metadata() {
            Ok(_) => folder = fs::canonicalize(&next)?,
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

    /// A project with folders, links inside and out, and a file; and where it lies.
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
    fn no_path_leads_out_of_the_project() {
        for path in [
            "..",
            "../outside",
            "machines/../../outside",
            "machines/..",
            ".",
            "./machines",
            "a/./b",
        ] {
            check(path, &expect!["400 Bad Request bad_path"]);
        }
        for path in ["/etc", "//etc", "/", "machines//one", "machines/", "a\0b"] {
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
