//! `rafcon show`: prints a machine for people and for other programs.

mod document;
mod dot;
mod mermaid;
mod order;
mod tree;

use crate::cli::{self, ShowFormat};
use crate::environment::Environment;
use crate::failure::complain;
use crate::machine::Source;
use crate::view::Paint;
use anyhow::Result;
use rafcon_model::notation::{self, Shown};
use std::io::{self, IsTerminal as _, Write as _};
use std::process::ExitCode;

/// The notation for people: scripts belong to a machine, layout does not, and libraries are their own machines.
const NOTATION: Shown = Shown { layout: false, scripts: true, contents: false };

/// Prints the machine, and problems of its files on the error output.
pub(super) fn show(raw: &cli::Show, environment: &Environment) -> Result<ExitCode> {
    let loaded = Source::new(&raw.path, &raw.libraries)?.load()?;
    for problem in &loaded.problems {
        complain(&format!("warning: {problem}"));
    }
    let machine = &loaded.machine;
    let text = match raw.format {
        ShowFormat::Tree => {
            let colour = io::stdout().is_terminal() && !environment.no_color;
            tree::draw(machine, Paint { colour, unicode: environment.unicode })
        }
        ShowFormat::TextNotation => notation::print_with(machine, NOTATION),
        ShowFormat::Json => document::print(machine)?,
        ShowFormat::Dot => dot::print(machine),
        ShowFormat::Mermaid => mermaid::print(machine),
    };
    io::stdout().write_all(text.as_bytes())?;
    Ok(ExitCode::SUCCESS)
}
