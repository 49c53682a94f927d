//! What a build makes: the `rafcon` binary and, beside it, the extension that a Python interpreter loads.

use std::path::PathBuf;

use anyhow::Result;

use crate::{process, workspace};

/// How it is built.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Profile {
    /// Quick to build, for tests.
    Debug,
    /// Quick to run, for figures and users.
    Release,
    /// The same with debugging symbols, to be packed.
    Symbols,
}

impl Profile {
    /// As cargo calls it.
    fn name(self) -> &'static str {
        match self {
            Self::Debug => "dev",
            Self::Release => "release",
            Self::Symbols => "symbols",
        }
    }
}

/// A finished build.
#[derive(Debug)]
pub(crate) struct Product {
    /// The command line program.
    pub(crate) binary: PathBuf,
    /// The extension module.
    pub(crate) extension: PathBuf,
}

impl Product {
    /// Builds the program and the extension. A debug build includes tests and examples: with the features that they need, each
    /// dependency is compiled once for all.
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

    /// What an earlier build made.
    pub(crate) fn built(profile: Profile) -> Result<Self> {
        let folder = workspace::target()?.join(match profile {
            Profile::Debug => "debug",
            Profile::Release | Profile::Symbols => profile.name(),
        });
        Ok(Self { binary: folder.join("rafcon"), extension: folder.join("librafcon_python.so") })
    }
}
