//! The reference: the PyPI package `rafcon`, installed for comparison only and used as a black box.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result};

use crate::{process, python, workspace};

/// The reference without its desktop packages, plus the dependencies of its core.
const CONTENTS: python::Contents = python::Contents {
    bare: &["rafcon==2.5.2"],
    full: &["jsonconversion<2", "yaml_configuration", "PyYAML", "psutil<6", "packaging", "numpy"],
};

#[derive(Debug)]
pub(crate) struct Reference {
    /// The interpreter of its virtual environment.
    pub(crate) python: PathBuf,
    /// The machines and libraries that it ships, `examples` and `libraries`.
    pub(crate) share: PathBuf,
}

impl Reference {
    /// Installs the reference below the target folder, if it is missing.
    pub(crate) fn installed() -> Result<Self> {
        let folder = workspace::target()?.join("reference-venv");
        let python = python::environment(&python::default()?, &folder, CONTENTS)?;
        let site = "import sysconfig; print(sysconfig.get_path('purelib'))";
        let site = process::text(python::command(&python).args(["-c", site]))?;
        let share = Path::new(site.trim()).join("rafcon/share/rafcon");
        share
            .is_dir()
            .then_some(())
            .with_context(|| format!("the reference ships nothing in {}", share.display()))?;
        Ok(Self { python, share })
    }

    /// The driver that runs one machine and prints one JSON object.
    pub(crate) fn driver(&self, machine: &Path) -> Command {
        let mut command = python::command(&self.python);
        command.arg(workspace::path("tests/conformance/reference_driver.py")).arg(machine);
        command
    }
}
