//! The pure-Python package `rafcon`, embedded in the extension, and its importer, which takes precedence over all others.

use pyo3::exceptions::{PyImportError, PySyntaxError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList};
use std::fmt::Write as _;

use crate::code_cache::CodeCache;

/// Paths below the package's parent folder, with `/`, and texts.
static FILES: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/package.rs"));

/// One module: its path and its text.
type Module = (&'static str, &'static str);

/// Serves the modules of `rafcon` from memory.
#[pyclass(frozen, module = "rafcon._native")]
#[derive(Debug)]
pub(crate) struct Importer {
    cache: Option<CodeCache>,
}

#[pymethods]
#[expect(clippy::unused_self, reason = "the protocol of importers has methods")]
impl Importer {
    /// Part of the protocol of `sys.meta_path`.
    #[pyo3(signature = (name, _path=None, _target=None))]
    fn find_spec<'py>(
        slf: &Bound<'py, Self>,
        name: &str,
        _path: Option<&Bound<'py, PyAny>>,
        _target: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        let Some((path, _)) = module(name) else { return Ok(None) };
        let py = slf.py();
        let details = PyDict::new(py);
        details.set_item("origin", origin(path))?;
        details.set_item("is_package", is_package(path))?;
        let machinery = py.import("importlib.machinery")?;
        let spec = machinery.getattr("ModuleSpec")?.call((name, slf), Some(&details))?;
        spec.setattr("has_location", true)?;
        if is_package(path) {
            spec.setattr("submodule_search_locations", PyList::empty(py))?;
        }
        Ok(Some(spec))
    }

    /// The default kind of module.
    fn create_module(&self, _spec: &Bound<'_, PyAny>) -> Option<Py<PyAny>> {
        None
    }

    /// Runs the body of a module.
    fn exec_module(&self, module: &Bound<'_, PyAny>) -> PyResult<()> {
        let py = module.py();
        let name: String = module.getattr("__name__")?.extract()?;
        let code = self.get_code(py, &name)?;
        py.import("builtins")?.getattr("exec")?.call1((code, module.getattr("__dict__")?))?;
        Ok(())
    }

    /// The text of a module, for tracebacks.
    fn get_source(&self, name: &str) -> PyResult<&'static str> {
        Ok(known(name)?.1)
    }

    /// The compiled text of a module.
    fn get_code<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let (path, text) = known(name)?;
        let marshal = py.import("marshal")?;
        if let Some(kept) = self.cache.as_ref().and_then(|cache| cache.read(name)) {
            return marshal.call_method1("loads", (PyBytes::new(py, &kept),));
        }
        let code = compiled(py, path, text)?;
        let wants_none: bool = py.import("sys")?.getattr("dont_write_bytecode")?.extract()?;
        if let Some(cache) = self.cache.as_ref().filter(|_| !wants_none) {
            let bytes = marshal.call_method1("dumps", (&code,))?;
            // On failure, the next start takes longer.
            cache.write(name, bytes.cast::<PyBytes>()?.as_bytes()).unwrap_or_default();
        }
        Ok(code)
    }

    /// True for a package.
    fn is_package(&self, name: &str) -> PyResult<bool> {
        Ok(is_package(known(name)?.0))
    }
}

/// Gives the package precedence over others of its name.
pub(crate) fn install(py: Python<'_>) -> PyResult<()> {
    let path = py.import("sys")?.getattr("meta_path")?;
    let cache = CodeCache::open(&version(py)?);
    path.call_method1("insert", (0, Py::new(py, Importer { cache })?))?;
    Ok(())
}

/// A name for all inputs of the compiled modules: their texts, the interpreter's format and its level of optimization.
fn version(py: Python<'_>) -> PyResult<String> {
    let mut hasher = blake3::Hasher::new();
    for (path, text) in FILES {
        for part in [path, text] {
            hasher.update(&part.len().to_le_bytes()).update(part.as_bytes());
        }
    }
    let format: Vec<u8> = py.import("importlib.util")?.getattr("MAGIC_NUMBER")?.extract()?;
    let level: u8 = py.import("sys")?.getattr("flags")?.getattr("optimize")?.extract()?;
    let mut name = hasher.finalize().to_hex()[..32].to_owned();
    for byte in format {
        write!(name, "-{byte:02x}").unwrap_or_default();
    }
    write!(name, "-{level}").unwrap_or_default();
    Ok(name)
}

fn compiled<'py>(py: Python<'py>, path: &str, text: &str) -> PyResult<Bound<'py, PyAny>> {
    let compile = py.import("builtins")?.getattr("compile")?;
    let options = PyDict::new(py);
    options.set_item("dont_inherit", true)?;
    compile.call((text, origin(path), "exec"), Some(&options)).map_err(|error| {
        if error.is_instance_of::<PySyntaxError>(py) {
            return PyImportError::new_err(format!("{path} does not parse: {error}"));
        }
        error
    })
}

fn module(name: &str) -> Option<Module> {
    if name.split('.').next() != Some("rafcon") {
        return None;
    }
    let stem = name.replace('.', "/");
    let found = |path: &str| FILES.iter().find(|(file, _)| *file == path).copied();
    found(&format!("{stem}/__init__.py")).or_else(|| found(&format!("{stem}.py")))
}

fn known(name: &str) -> PyResult<Module> {
    module(name).ok_or_else(|| PyImportError::new_err(format!("rafcon has no module {name}")))
}

fn is_package(path: &str) -> bool {
    path.ends_with("/__init__.py")
}

/// The file name in tracebacks, `<rafcon>/core/config.py`.
fn origin(path: &str) -> String {
    format!("<rafcon>/{}", path.strip_prefix("rafcon/").unwrap_or(path))
}
