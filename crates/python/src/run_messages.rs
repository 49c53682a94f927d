//! `rafcon._native.RunMessages`: what a runner says to the program around it, read from its frames. Knows their encoding; must
//! never know what a message leads to.

use parking_lot::Mutex;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rafcon_protocol::{FRAME_HEAD, FrameKind, read_frame_head};
use rafcon_storage::journal::stream::StreamReader;
use serde_json::json;

/// Reads the frames of one runner.
#[pyclass(frozen, module = "rafcon._native")]
#[derive(Debug)]
pub(crate) struct RunMessages {
    events: Mutex<StreamReader>,
}

#[pymethods]
impl RunMessages {
    #[new]
    fn new() -> Self {
        Self { events: Mutex::new(StreamReader::new(0, false, None)) }
    }

    /// How many bytes follow the head of a frame, which is as long as `HEAD` says.
    #[staticmethod]
    fn length(head: &[u8]) -> PyResult<usize> {
        Ok(kind_and_length(head)?.1)
    }

    /// The messages of a frame as JSON, events among them: `{"message": "event", "event": …}`.
    fn read(&self, head: &[u8], content: &[u8]) -> PyResult<Vec<String>> {
        match kind_and_length(head)?.0 {
            FrameKind::Message => Ok(vec![String::from_utf8_lossy(content).into_owned()]),
            FrameKind::Events => {
                let mut messages = Vec::new();
                let show = |_, _, event| {
                    messages.push(json!({ "message": "event", "event": event }).to_string());
                };
                let read = self.events.lock().read(content, show);
                read.map_err(|broken| PyValueError::new_err(broken.to_string()))?;
                Ok(messages)
            }
            FrameKind::Unknown => Ok(Vec::new()),
        }
    }

    /// How long the head of a frame is, in bytes.
    #[classattr]
    const HEAD: usize = FRAME_HEAD;
}

fn kind_and_length(head: &[u8]) -> PyResult<(FrameKind, usize)> {
    let head =
        head.try_into().map_err(|_cut| PyValueError::new_err("the head of a frame is cut"))?;
    Ok(read_frame_head(head)?)
}
