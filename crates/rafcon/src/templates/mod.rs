//! Templates of `rafcon new`, one module each.
//!
//! A template knows only the model: it makes a root state from a [`TemplateRequest`]. The command writes the files. A new
//! template is a module here and a line in [`ALL`].

mod empty;
mod hello;
mod mission;
mod rover;

use anyhow::{Result, bail};
use rafcon_model::State;

/// The user's request for a new machine.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct TemplateRequest {
    /// Name of the root state.
    pub(crate) name: String,
    /// Number of states (`--states`), for templates of variable size.
    pub(crate) states: Option<usize>,
}

/// A template for a new machine.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Template {
    /// Value of the option `--template`.
    pub(crate) name: &'static str,
    /// Short description for the help text.
    pub(crate) about: &'static str,
    /// True if the template supports `--states`.
    pub(crate) sized: bool,
    /// Required library roots: name, and location below a copy of this project.
    pub(crate) libraries: &'static [(&'static str, &'static str)],
    /// Makes the root state; deterministic for a request.
    pub(crate) build: fn(&TemplateRequest) -> Result<State>,
}

/// All templates, in the order of the help text.
pub(crate) const ALL: &[Template] =
    &[hello::TEMPLATE, mission::TEMPLATE, rover::TEMPLATE, empty::TEMPLATE];

/// The template with this name.
pub(crate) fn find(name: &str) -> Option<&'static Template> {
    ALL.iter().find(|template| template.name == name)
}

impl Template {
    /// Makes the root state; refuses options that the template does not support.
    pub(crate) fn root(&self, wish: &TemplateRequest) -> Result<State> {
        if wish.states.is_some() && !self.sized {
            bail!("the template `{}` has only one size: leave `--states` out", self.name);
        }
        (self.build)(wish)
    }
}

#[cfg(test)]
mod tests {
    use super::{ALL, TemplateRequest, find};
    use expect_test::expect;

    #[test]
    fn every_template_is_found_by_its_name_and_makes_a_root() {
        for template in ALL {
            let wish = TemplateRequest { name: "thing".to_owned(), states: None };
            let root = find(template.name).unwrap().root(&wish).unwrap();
            assert_eq!(root.name, "thing");
            assert!(!template.about.is_empty());
        }
    }

    #[test]
    fn a_size_for_a_template_of_one_size_is_refused() {
        let wish = TemplateRequest { name: "thing".to_owned(), states: Some(3) };
        let error = find("hello").unwrap().root(&wish).unwrap_err();
        expect!["the template `hello` has only one size: leave `--states` out"]
            .assert_eq(&error.to_string());
    }
}
