//! Serialization of values: as a view if that is complete, else as a pickle, else as a placeholder with the reason.
//!
//! Runs user code, so it must never be called with the engine locked.

use crate::runtime::Runtime;
use crate::view::view;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyType};
use rafcon_storage::journal::Stored;
use rafcon_storage::journal::record::Content;
use smol_str::SmolStr;
use std::fs::{self, DirBuilder, OpenOptions};
use std::io::{self, Write as _};
use std::os::unix::fs::{DirBuilderExt as _, OpenOptionsExt as _};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Maximum size, in bytes, of a pickle in the journal itself.
const INLINE_MAX: usize = 64 * 1024;
/// Maximum length, in characters, of the reason why a value cannot be kept.
const REASON_MAX: usize = 300;

/// Converts values for the journal.
#[derive(Debug, Clone)]
pub(crate) struct ValueSerializer {
    /// True if the run keeps values.
    keeps: bool,
    /// Folder of large values; without one they are in the journal.
    values: Option<PathBuf>,
}

impl ValueSerializer {
    /// A serializer that keeps no values.
    pub(crate) const NONE: Self = Self { keeps: false, values: None };

    /// A serializer of a run, with the folder of its large values.
    pub(crate) fn new(keeps: bool, values: Option<PathBuf>) -> Self {
        Self { keeps, values }
    }

    /// A serializer for values made before the run exists.
    pub(crate) fn before_the_run() -> Self {
        Self::new(true, None)
    }

    /// True if the run keeps values.
    pub(crate) fn keeps(&self) -> bool {
        self.keeps
    }

    /// The stored form of an object.
    pub(crate) fn stored(&self, object: &Bound<'_, PyAny>, type_name: SmolStr) -> Stored {
        let view = view(object);
        let content = if view.whole { Content::View } else { self.content(object) };
        Stored { view: view.json, type_name, content }
    }

    /// The stored form of an object, with the pickle of another object that carries additional data.
    pub(crate) fn stored_as(
        &self,
        object: &Bound<'_, PyAny>,
        type_name: SmolStr,
        carrier: &Bound<'_, PyAny>,
    ) -> Stored {
        Stored { view: view(object).json, type_name, content: self.content(carrier) }
    }

    fn content(&self, object: &Bound<'_, PyAny>) -> Content {
        match pickled(object) {
            Ok(pickle) => self.place(pickle.as_bytes()),
            Err(error) => Content::Nothing(reason(object, &error)),
        }
    }

    fn place(&self, pickle: &[u8]) -> Content {
        match &self.values {
            Some(folder) if pickle.len() > INLINE_MAX => put(folder, pickle),
            _ => Content::Pickle(pickle.to_vec()),
        }
    }
}

fn pickled<'py>(object: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyBytes>> {
    let pickle = Runtime::get(object.py())?.pickle.bind(object.py()).call1((object,))?;
    Ok(pickle.cast_into::<PyBytes>()?)
}

/// The reason why an object cannot be kept, with a remedy if possible.
fn reason(object: &Bound<'_, PyAny>, error: &PyErr) -> String {
    let class = match object.cast::<PyType>() {
        Ok(class) => class.clone(),
        Err(_instance) => object.get_type(),
    };
    let module = class.getattr("__module__").and_then(|module| module.extract::<String>());
    if module.is_ok_and(|module| is_script(&module)) {
        return "its class is defined in the script of a state, which no other process can import: \
                put the class into a module"
            .to_owned();
    }
    let kind = error.get_type(object.py()).name().map(|name| name.to_string_lossy().into_owned());
    let text = format!("{}: {}", kind.unwrap_or_default(), error.value(object.py()));
    text.chars().take(REASON_MAX).collect()
}

/// True for the name of a script module.
fn is_script(module: &str) -> bool {
    let number = module.strip_prefix("script").unwrap_or_default();
    !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit())
}

/// Writes a pickle to the file of its hash. On failure the value is not kept, and the run continues.
fn put(folder: &Path, pickle: &[u8]) -> Content {
    let hash = blake3::hash(pickle).to_hex().to_string();
    match write(folder, &hash, pickle) {
        Ok(()) => Content::File { hash, size: pickle.len() as u64 },
        Err(error) => Content::Nothing(format!(
            "its {} bytes cannot be written to {}: {error}",
            pickle.len(),
            folder.display()
        )),
    }
}

fn write(folder: &Path, hash: &str, pickle: &[u8]) -> io::Result<()> {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let file = folder.join(hash);
    if fs::metadata(&file).is_ok_and(|found| found.len() == pickle.len() as u64) {
        return Ok(());
    }
    DirBuilder::new().recursive(true).mode(0o700).create(folder)?;
    let staged = folder.join(format!(".{hash}.{}", COUNT.fetch_add(1, Ordering::Relaxed)));
    let written = OpenOptions::new()
        .write(true)
        .create(true)
        .truncate(true)
        .mode(0o600)
        .open(&staged)
        .and_then(|mut staged| staged.write_all(pickle))
        .and_then(|()| fs::rename(&staged, &file));
    if written.is_err() {
        // The half-written file is useless; a failed removal is harmless.
        drop(fs::remove_file(&staged));
    }
    written
}
