//! Where the extension is: the file that a Python interpreter loads to become a runner.

use crate::ProgramEnvironment;
use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::path::PathBuf;

/// It lies at none of its places.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "the extension that makes a Python a runner is missing. These places were tried:\n{}\n\
     Build it (`cargo build --workspace`), unpack the whole archive, or set RAFCON_EXTENSION to the file",
    listed(tried)
)]
pub struct NoExtension {
    tried: Vec<PathBuf>,
}

fn listed(places: &[PathBuf]) -> String {
    let lines: Vec<_> = places.iter().map(|place| format!("  {}", place.display())).collect();
    lines.join("\n")
}

/// The extension's file: beside this program (a plain `cargo build`), in `../lib/rafcon` (an installation), or where
/// `RAFCON_EXTENSION` says.
pub fn find(surroundings: &ProgramEnvironment) -> Result<PathBuf, NoExtension> {
    let places = places(surroundings);
    if let Some(found) = places.iter().find(|place| place.is_file()) {
        return Ok(found.clone());
    }
    Err(NoExtension { tried: places })
}

fn places(surroundings: &ProgramEnvironment) -> Vec<PathBuf> {
    let name = format!("{DLL_PREFIX}rafcon_python{DLL_SUFFIX}");
    let folder = surroundings.program.as_deref().and_then(|program| program.parent());
    let installed = |folder: &std::path::Path| {
        folder.parent().map(|prefix| prefix.join("lib/rafcon").join(&name))
    };
    let beside = folder.map(|folder| folder.join(&name));
    let places = [beside, folder.and_then(installed), surroundings.extension.clone()];
    places.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::find;
    use crate::ProgramEnvironment;
    use std::path::Path;

    fn installation(file: Option<&str>) -> (tempfile::TempDir, ProgramEnvironment) {
        let folder = tempfile::tempdir().unwrap();
        if let Some(file) = file {
            let file = folder.path().join(file);
            std::fs::create_dir_all(file.parent().unwrap()).unwrap();
            std::fs::write(file, "").unwrap();
        }
        let program = folder.path().join("bin/rafcon");
        let extension = folder.path().join("elsewhere.so");
        let surroundings = ProgramEnvironment {
            program: Some(program),
            extension: Some(extension),
            ..ProgramEnvironment::default()
        };
        (folder, surroundings)
    }

    #[test]
    fn it_is_found_beside_the_program_in_lib_or_where_the_variable_says() {
        for file in ["bin/librafcon_python.so", "lib/rafcon/librafcon_python.so", "elsewhere.so"] {
            let (folder, surroundings) = installation(Some(file));
            assert_eq!(find(&surroundings).unwrap(), folder.path().join(file));
        }
    }

    #[test]
    fn a_missing_extension_names_every_place() {
        let (folder, surroundings) = installation(None);
        let message = find(&surroundings).unwrap_err().to_string();
        for file in ["bin/librafcon_python.so", "lib/rafcon/librafcon_python.so", "elsewhere.so"] {
            assert!(message.contains(&*folder.path().join(Path::new(file)).to_string_lossy()));
        }
        assert!(message.contains("set RAFCON_EXTENSION"));
    }
}
