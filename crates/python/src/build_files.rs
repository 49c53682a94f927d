//! Loading and saving of machines for Python code that builds them, with the libraries that they use. Knows folders.

use crate::build::Document;
use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;
use rafcon_runner::{faults, reason};
use rafcon_storage::{Libraries, Naming, Root, load, save};
use smol_str::SmolStr;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// `rafcon._native.LibraryRoots`: folders with libraries, and a cache of the libraries read.
#[pyclass(frozen, module = "rafcon._native")]
#[derive(Debug)]
pub(crate) struct LibraryRoots {
    pub(crate) libraries: Arc<Libraries>,
}

#[pymethods]
impl LibraryRoots {
    /// Roots from pairs of key and folder.
    #[new]
    fn new(roots: Vec<(String, PathBuf)>) -> Self {
        let roots = roots.into_iter().map(|(name, dir)| Root { name: SmolStr::from(name), dir });
        Self { libraries: Arc::new(Libraries::new(roots.collect())) }
    }
}

/// `rafcon._native.load_document`: the machine in a folder, and the problems of its files and of itself.
#[pyfunction]
pub(crate) fn load_document(
    py: Python<'_>,
    path: &str,
    roots: &LibraryRoots,
) -> PyResult<(Document, Vec<String>)> {
    let libraries = Arc::clone(&roots.libraries);
    let loaded = py.detach(|| load(Path::new(path), &libraries)).map_err(|error| {
        PyValueError::new_err(format!("this is no state machine: {}", reason(&error)))
    })?;
    let of_files = loaded.problems.iter().filter(|problem| !problem.is_found_by_rules());
    let problems = of_files.map(ToString::to_string).chain(faults(&loaded.machine)).collect();
    Ok((Document::of(loaded.machine, Some(loaded.saved), libraries), problems))
}

/// `rafcon._native.save_document`: writes the machine to a folder. `naming` sets if folders contain names, and of what
/// length. `how` sets if it is a copy, which keeps the document's folder, and if the folder is new.
#[pyfunction]
pub(crate) fn save_document(
    py: Python<'_>,
    document: &Document,
    folder: &str,
    naming: (bool, Option<usize>),
    how: (bool, bool),
) -> PyResult<()> {
    let ((with_name, max_name_length), (as_copy, fresh)) = (naming, how);
    let naming = Naming { with_name, max_name_length };
    let (machine, saved) = {
        let content = document.lock(py);
        (content.machine.clone(), content.saved.clone())
    };
    let known = saved.as_ref().filter(|_| !fresh);
    let written = py.detach(|| save(&machine, Path::new(folder), known, naming));
    let written = written.map_err(|error| PyOSError::new_err(reason(&error)))?;
    if !as_copy {
        document.lock(py).saved = Some(written);
    }
    Ok(())
}
