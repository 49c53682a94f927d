//! Python on this machine: installed interpreters, and virtual environments below the target folder.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result};

use crate::process;

/// Tested Python versions, as minor numbers of Python 3.
const MINORS: std::ops::RangeInclusive<u32> = 9..=14;

#[derive(Debug, Clone)]
pub(crate) struct Interpreter {
    /// Version, such as `3.11`.
    pub(crate) version: String,
    /// Path of the program itself, never of a shim.
    pub(crate) program: PathBuf,
}

/// Packages of a virtual environment; pip runs only when this list changes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Contents {
    /// Packages to install without their dependencies.
    pub(crate) bare: &'static [&'static str],
    /// Packages to install with their dependencies.
    pub(crate) full: &'static [&'static str],
}

/// The interpreter that `python3` starts.
pub(crate) fn default() -> Result<Interpreter> {
    probe("python3".as_ref())
        .context("no `python3` on the path: install Python 3.9 or newer, with venv")
}

/// One interpreter for each Python version found in the path or among pyenv's versions.
pub(crate) fn all() -> Vec<Interpreter> {
    MINORS.filter_map(|minor| candidates(minor).iter().find_map(|program| probe(program))).collect()
}

fn candidates(minor: u32) -> Vec<PathBuf> {
    let mut found = vec![PathBuf::from(format!("python3.{minor}"))];
    let folders = pyenv().and_then(|folder| std::fs::read_dir(folder.join("versions")).ok());
    let folders = folders.into_iter().flatten().flatten().map(|entry| entry.path());
    let right = |folder: &PathBuf| {
        folder
            .file_name()
            .is_some_and(|name| name.to_string_lossy().starts_with(&format!("3.{minor}.")))
    };
    found.extend(folders.filter(right).map(|folder| folder.join("bin/python3")));
    found
}

fn pyenv() -> Option<PathBuf> {
    let home = || std::env::var_os("HOME").map(|home| Path::new(&home).join(".pyenv"));
    std::env::var_os("PYENV_ROOT").map(PathBuf::from).or_else(home)
}

/// Queries the version of the program; `None` if it does not start or is a free-threaded build.
fn probe(program: &Path) -> Option<Interpreter> {
    let question = "import sys; free = getattr(sys, '_is_gil_enabled', lambda: True)() is False; \
                    print('%d.%d' % sys.version_info[:2], free, sys.executable)";
    let output = Command::new(program)
        .args(["-c", question])
        .output()
        .ok()
        .filter(|output| output.status.success())?;
    let answer = String::from_utf8(output.stdout).ok()?;
    let mut words = answer.trim().splitn(3, ' ');
    let (version, free, program) = (words.next()?, words.next()?, words.next()?);
    (free == "False")
        .then(|| Interpreter { version: version.to_owned(), program: PathBuf::from(program) })
}

/// The Python of a virtual environment in `folder`, which is created and filled if necessary.
pub(crate) fn environment(
    base: &Interpreter,
    folder: &Path,
    contents: Contents,
) -> Result<PathBuf> {
    let program = folder.join("bin/python");
    let stamp = folder.join("contents.txt");
    let wanted = format!("{} {contents:?}", base.program.display());
    if program.exists() && std::fs::read_to_string(&stamp).is_ok_and(|found| found == wanted) {
        return Ok(program);
    }
    process::run(process::command(&base.program).args(["-m", "venv", "--clear"]).arg(folder))?;
    install(&program, &["--no-deps"], contents.bare)?;
    install(&program, &[], contents.full)?;
    std::fs::write(&stamp, wanted).with_context(|| format!("cannot write {}", stamp.display()))?;
    Ok(program)
}

fn install(python: &Path, options: &[&str], packages: &[&str]) -> Result<()> {
    if packages.is_empty() {
        return Ok(());
    }
    let pip = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
    process::run(process::command(python).args(pip).args(options).args(packages))
}

/// The unpacked source distribution of a package below `folder`, downloaded if necessary.
pub(crate) fn sources(
    base: &Interpreter,
    folder: &Path,
    name: &str,
    version: &str,
) -> Result<PathBuf> {
    let unpacked = folder.join(format!("{name}-{version}"));
    if unpacked.join("setup.py").exists() {
        return Ok(unpacked);
    }
    std::fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let pip = ["-m", "pip", "download", "--quiet", "--no-deps", "--no-binary", ":all:"];
    let package = format!("{name}=={version}");
    process::run(process::command(&base.program).args(pip).arg(package).current_dir(folder))?;
    let archive = format!("{name}-{version}.tar.gz");
    let unpack = ["-m", "tarfile", "-e", archive.as_str()];
    process::run(process::command(&base.program).args(unpack).current_dir(folder))?;
    Ok(unpacked)
}

/// A command of this Python in isolation: no user site, and no byte code in the sources.
pub(crate) fn command(python: &Path) -> Command {
    let mut command = process::command(python);
    command
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env("PYTHONNOUSERSITE", "1")
        .env("PYTHONUNBUFFERED", "1");
    for name in
        ["PYTHONPATH", "PYTHONHOME", "RAFCON_LIB_PATH", "RAFCON_LIBRARY_PATH", "RAFCON_PLUGIN_PATH"]
    {
        command.env_remove(OsString::from(name));
    }
    command
}
