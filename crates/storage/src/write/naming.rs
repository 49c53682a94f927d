//! Name of a state's folder (see "folder names" in `docs/format.md`). Handles text only.

use crate::config::Naming;
use rafcon_model::{State, StateId};
use std::ffi::{OsStr, OsString};

/// Maximum length of a file name, in bytes.
const LONGEST: usize = 255;

/// Returns the folder's name: the characters of the state's name and id that are safe in a file name.
pub(crate) fn folder_name(state: &State, naming: Naming) -> String {
    let id = plain_id(&state.id);
    if !naming.with_name {
        return id;
    }
    let room = LONGEST.saturating_sub(id.len() + 1);
    let most = naming.max_name_length.map_or(room, |most| most.min(room));
    format!("{}_{id}", shortened(&sanitized(&state.name), most))
}

/// Returns the name itself, or the name with a number appended if it is taken.
pub(crate) fn free_name(wanted: &str, is_taken: impl Fn(&OsStr) -> bool) -> OsString {
    let mut name = OsString::from(wanted);
    let mut number = 2_u64;
    while is_taken(&name) {
        name = OsString::from(format!("{wanted}_{number}"));
        number += 1;
    }
    name
}

/// Replaces spaces and stars by `_`, and removes all other characters except ASCII letters, digits, `_` and `-`.
fn sanitized(name: &str) -> String {
    let replaced = name.chars().map(|c| if matches!(c, ' ' | '*') { '_' } else { c });
    replaced.filter(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '-')).collect()
}

/// Returns the start and the end of a name that is too long, joined by `_`.
fn shortened(name: &str, most: usize) -> String {
    if name.len() <= most {
        return name.to_owned();
    }
    let kept = most.saturating_sub(1);
    let end = &name[name.len() - kept / 2..];
    if most == 0 { String::new() } else { format!("{}_{end}", &name[..kept.div_ceil(2)]) }
}

/// Returns an id as a file name. Unsafe characters are removed, and long ids are cut.
fn plain_id(id: &StateId) -> String {
    let mut plain = sanitized(id.as_str());
    plain.truncate(LONGEST / 2);
    if plain.is_empty() { "_".to_owned() } else { plain }
}

#[cfg(test)]
mod tests {
    use super::{Naming, folder_name, free_name};
    use rafcon_model::{Kind, Script, State};

    fn check(name: &str, id: &str, max_name_length: Option<usize>, folder: &str) {
        let state = State::new(id.into(), name, Kind::Execution(Script::default()));
        assert_eq!(folder_name(&state, Naming { with_name: true, max_name_length }), folder);
    }

    #[test]
    fn names_keep_what_is_safe() {
        check("ex ec*é(1)", "ABCDEF", None, "ex_ec_1_ABCDEF");
        check("é", "ABCDEF", None, "_ABCDEF");
        check("a", "../../x", None, "a_x");
        check("a", "..", None, "a__");
    }

    #[test]
    fn long_names_lose_their_middle() {
        check("abcdefghij", "ABCDEF", Some(6), "abc_ij_ABCDEF");
        check("abcdefghij", "ABCDEF", Some(10), "abcdefghij_ABCDEF");
        check("abcdefghij", "ABCDEF", Some(1), "__ABCDEF");
        let long = "x".repeat(300);
        check(&long, "ABCDEF", Some(9999), &format!("{}_{}_ABCDEF", &long[..124], &long[..123]));
    }

    #[test]
    fn without_names_the_id_is_enough() {
        let state = State::new("ABCDEF".into(), "a", Kind::Execution(Script::default()));
        let naming = Naming { with_name: false, max_name_length: None };
        assert_eq!(folder_name(&state, naming), "ABCDEF");
    }

    #[test]
    fn a_taken_name_gets_a_number() {
        assert_eq!(free_name("a_B", |name| name == "a_B" || name == "a_B_2"), "a_B_3");
    }
}
