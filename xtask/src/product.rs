//! The products of a build: the `rafcon` binary and, next to it, the extension for Python interpreters.

use std::path::PathBuf;

use anyhow::Result;

use crate::{process, workspace};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Profile {
    /// Fast to build, for tests.
    Debug,
    /// Fast to run, for measurements and users.
    Release,
    /// Release with debugging symbols, for packages.
    Symbols,
}

impl Profile {
    /// Name of the profile in cargo.
    fn name(self) -> &'static str {
        match self {
            Self::Debug => "dev",
            Self::Release => "release",
            Self::Symbols => "symbols",
        }
    }
}

#[derive(Debug)]
pub(crate) struct Product {
    /// The command line program.
    pub(crate) binary: PathBuf,
    /// Path of the extension module.
    pub(crate) extension: PathBuf,
}

impl Product {
    /// Builds the program and the extension. A debug build includes tests and examples, so that each dependency is compiled
    /// only once, with the features for all of them.
    pub(crate) fn build(profile: Profile) -> Result<Self> {
        let mut cargo = process::cargo();
        cargo.args(["build", "--profile", profile.name()]);
        match profile {
            Profile::Debug => {
                cargo.args(["--workspace", "--lib", "--bins", "--tests", "--examples"])
            }
            Profile::Release | Profile::Symbols => {
                cargo.args(["-p", "rafcon", "-p", "rafcon-python"])
            }
        };
        process::run(&mut cargo)?;
        Self::built(profile)
    }

    /// The products of an earlier build.
    pub(crate) fn built(profile: Profile) -> Result<Self> {
        let folder = workspace::target()?.join(match profile {
            Profile::Debug => "debug",
            Profile::Release | Profile::Symbols => profile.name(),
        });
        Ok(Self { binary: folder.join("rafcon"), extension: folder.join("librafcon_python.so") })
    }
}
