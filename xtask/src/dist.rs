//! What a user installs: an archive with binary (which carries the page), extension and examples, and a Python wheel.

use std::path::Path;

use anyhow::{Context as _, Result};

use crate::product::{Product, Profile};
use crate::{process, python, web, workspace};

const MATURIN: python::Contents = python::Contents { bare: &[], full: &["maturin>=1.9,<2"] };

/// The papers that go with the programs.
const PAPERS: [&str; 4] = ["README.md", "CHANGELOG.md", "LICENSE-MIT", "LICENSE-APACHE"];

/// Packs both into `dist` below the target folder.
pub(crate) fn run() -> Result<()> {
    web::build()?;
    let product = Product::build(Profile::Release)?;
    let folder = workspace::target()?.join("dist");
    create(&folder)?;
    archive(&product, &folder)?;
    wheel(&folder)?;
    println!("packed into {}", folder.display());
    Ok(())
}

fn archive(product: &Product, folder: &Path) -> Result<()> {
    let name = format!(
        "rafcon-{}-{}-{}",
        env!("CARGO_PKG_VERSION"),
        std::env::consts::OS,
        std::env::consts::ARCH
    );
    let stage = folder.join(&name);
    if stage.exists() {
        std::fs::remove_dir_all(&stage)
            .with_context(|| format!("cannot remove {}", stage.display()))?;
    }
    create(&stage.join("bin"))?;
    create(&stage.join("lib/rafcon"))?;
    copy(&product.binary, &stage.join("bin/rafcon"))?;
    copy(&product.extension, &stage.join("lib/rafcon/librafcon_python.so"))?;
    for paper in PAPERS {
        copy(&workspace::path(paper), &stage.join(paper))?;
    }
    workspace::copy("examples", &stage.join("examples"))?;
    let mut tar = process::command("tar");
    process::run(
        tar.arg("--create")
            .arg("--gzip")
            .arg("--directory")
            .arg(folder)
            .args(["--file"])
            .arg(format!("{}.tar.gz", stage.display()))
            .arg(name),
    )
}

/// The wheel carries extension and Python package; its import name is `rafcon`.
fn wheel(folder: &Path) -> Result<()> {
    let environment = workspace::target()?.join("dist-venv");
    let python = python::environment(&python::default()?, &environment, MATURIN)?;
    let mut maturin = process::command(python);
    maturin.args([
        "-m",
        "maturin",
        "build",
        "--release",
        "--manifest-path",
        "crates/python/Cargo.toml",
        "--out",
    ]);
    process::run(maturin.arg(folder))
}

fn create(folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder).with_context(|| format!("cannot create {}", folder.display()))
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    std::fs::copy(from, to)
        .with_context(|| format!("cannot copy {} to {}", from.display(), to.display()))?;
    Ok(())
}
