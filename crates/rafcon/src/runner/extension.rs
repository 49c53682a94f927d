//! Where the extension is: the file that a Python interpreter loads to become a runner.

use crate::environment::Environment;
use anyhow::{Result, bail};
use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::path::PathBuf;

/// The extension's file: beside this program (a plain `cargo build`), in `../lib/rafcon` (an installation), or where
/// `RAFCON_EXTENSION` says.
pub(crate) fn find(environment: &Environment) -> Result<PathBuf> {
    let places = places(environment);
    if let Some(found) = places.iter().find(|place| place.is_file()) {
        return Ok(found.clone());
    }
    let tried: Vec<_> = places.iter().map(|place| format!("  {}", place.display())).collect();
    bail!(
        "the extension that makes a Python a runner is missing. These places were tried:\n{}\n\
         Build it (`cargo build --workspace`), unpack the whole archive, or set RAFCON_EXTENSION to the file",
        tried.join("\n")
    )
}

fn places(environment: &Environment) -> Vec<PathBuf> {
    let name = format!("{DLL_PREFIX}rafcon_python{DLL_SUFFIX}");
    let folder = environment.program.as_deref().and_then(|program| program.parent());
    let installed = |folder: &std::path::Path| {
        folder.parent().map(|prefix| prefix.join("lib/rafcon").join(&name))
    };
    let beside = folder.map(|folder| folder.join(&name));
    let places = [beside, folder.and_then(installed), environment.extension.clone()];
    places.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::find;
    use crate::environment::Environment;
    use std::path::Path;

    fn installation(file: Option<&str>) -> (tempfile::TempDir, Environment) {
        let folder = tempfile::tempdir().unwrap();
        if let Some(file) = file {
            let file = folder.path().join(file);
            std::fs::create_dir_all(file.parent().unwrap()).unwrap();
            std::fs::write(file, "").unwrap();
        }
        let program = folder.path().join("bin/rafcon");
        let extension = folder.path().join("elsewhere.so");
        let environment = Environment {
            program: Some(program),
            extension: Some(extension),
            ..Environment::default()
        };
        (folder, environment)
    }

    #[test]
    fn it_is_found_beside_the_program_in_lib_or_where_the_variable_says() {
        for file in ["bin/librafcon_python.so", "lib/rafcon/librafcon_python.so", "elsewhere.so"] {
            let (folder, environment) = installation(Some(file));
            assert_eq!(find(&environment).unwrap(), folder.path().join(file));
        }
    }

    #[test]
    fn a_missing_extension_names_every_place() {
        let (folder, environment) = installation(None);
        let message = find(&environment).unwrap_err().to_string();
        for file in ["bin/librafcon_python.so", "lib/rafcon/librafcon_python.so", "elsewhere.so"] {
            assert!(message.contains(&*folder.path().join(Path::new(file)).to_string_lossy()));
        }
        assert!(message.contains("set RAFCON_EXTENSION"));
    }
}
