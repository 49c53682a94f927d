//! Library states that a program makes instead of reading them from a file. Knows the model; the looking up is done by
//! [`Libraries`].

use super::library_content::Contents;
use crate::Libraries;
use crate::libraries::Loading;
use crate::problem::Fault;
use rafcon_model::State;
use std::path::PathBuf;

/// Looks up the library of `state`, which stands in no machine yet, and takes outcomes and ports from it. The answer says
/// what does not fit; a state of another kind stays as it is.
pub fn fill_library(state: &mut State, libraries: &Libraries) -> Vec<Fault> {
    Contents::new(libraries, &Loading::first(PathBuf::new())).fill(state)
}
