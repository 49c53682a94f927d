//! Ids of projects: short names that are stable across restarts. Pure.

use rafcon_protocol::api::Project;
use std::path::PathBuf;

/// The folders as projects with unique ids.
pub(super) fn named(folders: impl Iterator<Item = PathBuf>) -> Vec<Project> {
    let mut known: Vec<Project> = Vec::new();
    for folder in folders {
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let id = unique(&slug(&name), &known);
        known.push(Project { id, name, folder: folder.to_string_lossy().into_owned() });
    }
    known
}

/// A name that needs no escaping in a URL.
fn slug(name: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-' | '.');
    let text = name.chars().map(|c| if plain(c) { c } else { '-' }).collect::<String>();
    let text = text.trim_matches(['-', '.']);
    if text.is_empty() { "project".to_owned() } else { text.to_owned() }
}

fn unique(slug: &str, known: &[Project]) -> String {
    let is_free = |id: &String| known.iter().all(|project| project.id != *id);
    let numbered = (2..).map(|number: u32| format!("{slug}-{number}"));
    std::iter::once(slug.to_owned()).chain(numbered).find(is_free).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use expect_test::{Expect, expect};

    fn check(folders: &[&str], expected: &Expect) {
        let projects = named(folders.iter().map(PathBuf::from));
        let ids = projects.into_iter().map(|project| project.id).collect::<Vec<_>>();
        expected.assert_eq(&ids.join(" "));
    }

    #[test]
    fn an_id_is_the_folders_name_as_addresses_can_hold_it() {
        check(
            &["/a/mission", "/Über uns", "/", "/a/.hidden", "/x/v1.2"],
            &expect!["mission ber-uns project hidden v1.2"],
        );
    }

    #[test]
    fn folders_of_one_name_have_numbers() {
        check(&["/a/m", "/b/m", "/c/m-2", "/d/m"], &expect!["m m-2 m-2-2 m-3"]);
    }
}
