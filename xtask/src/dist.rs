//! Packages for users: an archive and a Python wheel. The archive contains the binary with the page, the extension,
//! `rafcon-ros`, examples, libraries, and the ROS package with the types of the bridge. The debugging symbols of its
//! programs are packed separately.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};

use crate::product::{Product, Profile};
use crate::{process, python, ros_helper, web, workspace};

const MATURIN: python::Contents = python::Contents { bare: &[], full: &["maturin>=1.9,<2"] };

/// Documents in the archive.
const PAPERS: [&str; 4] = ["README.md", "CHANGELOG.md", "LICENSE-MIT", "LICENSE-APACHE"];

/// Folders in the archive, by their names in the repository.
const FOLDERS: [&str; 3] = ["examples", "libraries", "ros/rafcon_msgs"];

/// Packs archive and wheel into `dist` below the target folder.
pub(crate) fn run() -> Result<()> {
    web::build()?;
    let product = Product::build(Profile::Symbols)?;
    let helper = ros_helper::build(Profile::Symbols)?;
    let folder = workspace::target()?.join("dist");
    create(&folder)?;
    archive(&product, &helper, &folder)?;
    wheel(&folder)?;
    println!("packed into {}", folder.display());
    Ok(())
}

fn archive(product: &Product, helper: &Path, folder: &Path) -> Result<()> {
    let name = format!(
        "rafcon-{}-{}-{}",
        env!("CARGO_PKG_VERSION"),
        std::env::consts::OS,
        std::env::consts::ARCH
    );
    let stage = emptied(folder.join(&name))?;
    let symbols = emptied(folder.join(format!("{name}-symbols")))?;
    create(&stage.join("bin"))?;
    create(&stage.join("lib/rafcon"))?;
    split(&product.binary, &stage.join("bin/rafcon"), &symbols)?;
    split(helper, &stage.join("bin/rafcon-ros"), &symbols)?;
    split(&product.extension, &stage.join("lib/rafcon/librafcon_python.so"), &symbols)?;
    for paper in PAPERS {
        copy(&workspace::path(paper), &stage.join(paper))?;
    }
    for folder in FOLDERS {
        workspace::copy(folder, &stage.join(folder))?;
    }
    copy(&workspace::path("ros/NOTICE"), &stage.join("ros/NOTICE"))?;
    pack(&stage)?;
    pack(&symbols)
}

/// An existing, empty folder.
fn emptied(folder: PathBuf) -> Result<PathBuf> {
    if folder.exists() {
        std::fs::remove_dir_all(&folder)
            .with_context(|| format!("cannot remove {}", folder.display()))?;
    }
    create(&folder)?;
    Ok(folder)
}

/// Copies a program without its symbols, which go into `symbols` under its name. Debuggers find them by the link in the
/// program.
fn split(program: &Path, to: &Path, symbols: &Path) -> Result<()> {
    let name = to.file_name().context("a program has a name")?.to_string_lossy();
    let kept = symbols.join(format!("{name}.debug"));
    let objcopy = || process::command("objcopy");
    process::run(objcopy().arg("--only-keep-debug").arg(program).arg(&kept))?;
    let mut link = std::ffi::OsString::from("--add-gnu-debuglink=");
    link.push(&kept);
    process::run(objcopy().arg("--strip-unneeded").arg(link).arg(program).arg(to))
}

/// Packs a folder into an archive next to it.
fn pack(folder: &Path) -> Result<()> {
    let (Some(around), Some(name)) = (folder.parent(), folder.file_name()) else {
        anyhow::bail!("{} is no folder to pack", folder.display());
    };
    let mut archive = folder.as_os_str().to_owned();
    archive.push(".tar.gz");
    let mut tar = process::command("tar");
    tar.args(["--create", "--gzip", "--directory"]).arg(around).arg("--file").arg(archive);
    process::run(tar.arg(name))
}

/// The wheel with extension and Python package; its import name is `rafcon`.
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

#[cfg(test)]
mod tests {
    use super::FOLDERS;
    use crate::workspace;

    /// Clients that send goals to `run_machine` build this package, so it must be complete.
    #[test]
    fn the_package_of_ros_is_packed_with_all_its_interfaces() {
        let packed = FOLDERS.iter().flat_map(|folder| workspace::files(folder).unwrap());
        let packed: Vec<String> = packed.map(|file| file.display().to_string()).collect();
        let package: Vec<&str> =
            packed.iter().filter_map(|file| file.strip_prefix("ros/rafcon_msgs/")).collect();
        let built =
            std::fs::read_to_string(workspace::path("ros/rafcon_msgs/CMakeLists.txt")).unwrap();
        let (interfaces, others): (Vec<&str>, Vec<&str>) =
            package.into_iter().partition(|file| file.contains('/'));
        assert_eq!(others, ["CMakeLists.txt", "package.xml"]);
        assert!(interfaces.contains(&"action/RunMachine.action"));
        for interface in &interfaces {
            assert!(built.contains(&format!("\"{interface}\"")), "{interface} is not built");
        }
        let named = built.matches(".msg\"").count()
            + built.matches(".srv\"").count()
            + built.matches(".action\"").count();
        assert_eq!(named, interfaces.len(), "some are built that are not there");
        assert!(packed.iter().any(|file| file == "libraries/ros2/act/script.py"));
    }
}
