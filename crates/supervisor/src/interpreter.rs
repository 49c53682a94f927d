//! Selects the Python for scripts, and finds the extension that makes it a runner. Python is the one that is named, else that of the
//! active virtual environment, else `python3`.
//!
//! The environment is an explicit value: programs read it once, when they start.

use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::fmt;
use std::path::{Path, PathBuf};

/// The relevant environment variables, and the path of this program.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ProgramEnvironment {
    /// `VIRTUAL_ENV`: the active virtual environment.
    pub virtual_env: Option<PathBuf>,
    /// `RAFCON_EXTENSION`: the extension's file, for unusual installations.
    pub extension: Option<PathBuf>,
    /// Path of this program, with links resolved.
    pub program: Option<PathBuf>,
    /// `HOME`: the home folder of the user.
    pub home: Option<PathBuf>,
    /// `XDG_STATE_HOME`: the folder for state of programs.
    pub state_home: Option<PathBuf>,
}

/// A chosen interpreter and the reason of the choice, for messages.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Interpreter {
    /// A file, or a name that is searched on the PATH.
    pub program: PathBuf,
    reason: Reason,
}

/// The active virtual environment contains no interpreter.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "the active virtual environment {} has no bin/python3: leave it (`deactivate`), make it again, or name an \
     interpreter with --python",
    folder.display()
)]
pub struct NoInterpreter {
    folder: PathBuf,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Reason {
    Named,
    VirtualEnvironment,
    Default,
}

impl Interpreter {
    /// Selects an interpreter. `named` is `--python` or `RAFCON_PYTHON`.
    pub fn choose(
        named: Option<&Path>,
        environment: &ProgramEnvironment,
    ) -> Result<Self, NoInterpreter> {
        if let Some(program) = named {
            return Ok(Self { program: program.to_path_buf(), reason: Reason::Named });
        }
        let Some(folder) = &environment.virtual_env else {
            return Ok(Self { program: "python3".into(), reason: Reason::Default });
        };
        let candidates = ["bin/python3", "bin/python"].map(|name| folder.join(name));
        match candidates.into_iter().find(|program| program.exists()) {
            Some(program) => Ok(Self { program, reason: Reason::VirtualEnvironment }),
            None => Err(NoInterpreter { folder: folder.clone() }),
        }
    }

    /// Remedy if the interpreter cannot be started.
    pub fn way_out(&self) -> &'static str {
        match self.reason {
            Reason::Named => "--python or RAFCON_PYTHON must name a Python 3.9 or newer",
            Reason::VirtualEnvironment => "VIRTUAL_ENV is set: leave or repair that environment",
            Reason::Default => "install Python 3.9 or newer, or name one with --python",
        }
    }
}

impl fmt::Display for Interpreter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.program.display().fmt(f)
    }
}

/// The extension was not found.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "cannot find the Python extension of RAFCON. Searched:\n{}\n\
     Build it (`cargo build --workspace`), unpack the complete archive, or set RAFCON_EXTENSION to the file",
    listed(tried)
)]
pub struct NoExtension {
    tried: Vec<PathBuf>,
}

fn listed(places: &[PathBuf]) -> String {
    let lines: Vec<_> = places.iter().map(|place| format!("  {}", place.display())).collect();
    lines.join("\n")
}

/// Finds the extension's file: beside this program (a plain `cargo build`), in `../lib/rafcon` (an installation), or at `RAFCON_EXTENSION`.
pub fn find_extension(environment: &ProgramEnvironment) -> Result<PathBuf, NoExtension> {
    let places = places(environment);
    if let Some(found) = places.iter().find(|place| place.is_file()) {
        return Ok(found.clone());
    }
    Err(NoExtension { tried: places })
}

fn places(environment: &ProgramEnvironment) -> Vec<PathBuf> {
    let name = format!("{DLL_PREFIX}rafcon_python{DLL_SUFFIX}");
    let folder = environment.program.as_deref().and_then(|program| program.parent());
    let installed =
        |folder: &Path| folder.parent().map(|prefix| prefix.join("lib/rafcon").join(&name));
    let beside = folder.map(|folder| folder.join(&name));
    let places = [beside, folder.and_then(installed), environment.extension.clone()];
    places.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::{Interpreter, ProgramEnvironment, find_extension};
    use expect_test::{Expect, expect};
    use std::path::Path;

    fn check(named: Option<&str>, virtual_env: Option<&Path>, expect: &Expect) {
        let environment = ProgramEnvironment {
            virtual_env: virtual_env.map(Into::into),
            ..ProgramEnvironment::default()
        };
        let chosen = Interpreter::choose(named.map(Path::new), &environment);
        expect.assert_eq(&match chosen {
            Ok(interpreter) => format!("{interpreter}; {}", interpreter.way_out()),
            Err(error) => error.to_string(),
        });
    }

    #[test]
    fn the_one_that_was_named_wins() {
        check(
            Some("python3.12"),
            Some(Path::new("/nowhere")),
            &expect!["python3.12; --python or RAFCON_PYTHON must name a Python 3.9 or newer"],
        );
    }

    #[test]
    fn then_the_active_virtual_environment() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("bin")).unwrap();
        std::fs::write(folder.path().join("bin/python"), "").unwrap();
        let environment = ProgramEnvironment {
            virtual_env: Some(folder.path().to_path_buf()),
            ..ProgramEnvironment::default()
        };
        let chosen = Interpreter::choose(None, &environment).unwrap();
        assert_eq!(chosen.program, folder.path().join("bin/python"));
    }

    #[test]
    fn a_virtual_environment_without_python_is_an_error_and_not_skipped() {
        check(
            None,
            Some(Path::new("/nowhere")),
            &expect![
                "the active virtual environment /nowhere has no bin/python3: leave it (`deactivate`), make it again, or name an interpreter with --python"
            ],
        );
    }

    #[test]
    fn then_python3() {
        check(
            None,
            None,
            &expect!["python3; install Python 3.9 or newer, or name one with --python"],
        );
    }

    fn installation(file: Option<&str>) -> (tempfile::TempDir, ProgramEnvironment) {
        let folder = tempfile::tempdir().unwrap();
        if let Some(file) = file {
            let file = folder.path().join(file);
            std::fs::create_dir_all(file.parent().unwrap()).unwrap();
            std::fs::write(file, "").unwrap();
        }
        let program = folder.path().join("bin/rafcon");
        let extension = folder.path().join("elsewhere.so");
        let environment = ProgramEnvironment {
            program: Some(program),
            extension: Some(extension),
            ..ProgramEnvironment::default()
        };
        (folder, environment)
    }

    #[test]
    fn it_is_found_beside_the_program_in_lib_or_where_the_variable_says() {
        for file in ["bin/librafcon_python.so", "lib/rafcon/librafcon_python.so", "elsewhere.so"] {
            let (folder, environment) = installation(Some(file));
            assert_eq!(find_extension(&environment).unwrap(), folder.path().join(file));
        }
    }

    #[test]
    fn a_missing_extension_names_every_place() {
        let (folder, environment) = installation(None);
        let message = find_extension(&environment).unwrap_err().to_string();
        for file in ["bin/librafcon_python.so", "lib/rafcon/librafcon_python.so", "elsewhere.so"] {
            assert!(message.contains(&*folder.path().join(Path::new(file)).to_string_lossy()));
        }
        assert!(message.contains("set RAFCON_EXTENSION"));
    }
}
