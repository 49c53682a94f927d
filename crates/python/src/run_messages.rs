//! `rafcon._native.RunMessages`: decodes the frames that a runner sends to the program around it. Does not know the effect
//! of a message.

use parking_lot::Mutex;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rafcon_protocol::{FRAME_HEAD, FrameKind, read_frame_head};
use rafcon_storage::journal::stream::StreamReader;
use serde_json::json;

/// Decodes the frames of one runner.
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

    /// Messages of the next frame of a stream as JSON, events among them: `{"message": "event", "event": …}`. `None` at the
    /// end of the stream or at a truncated frame.
    fn next(&self, stream: &Bound<'_, PyAny>) -> PyResult<Option<Vec<String>>> {
        let head = stream.call_method1("read", (FRAME_HEAD,))?;
        let Ok(head) = head.extract::<&[u8]>()?.try_into() else { return Ok(None) };
        let (kind, length) = read_frame_head(head)?;
        let content = stream.call_method1("read", (length,))?;
        let content = content.extract::<&[u8]>()?;
        if content.len() < length {
            return Ok(None);
        }
        self.read(kind, content).map(Some)
    }
}

impl RunMessages {
    fn read(&self, kind: FrameKind, content: &[u8]) -> PyResult<Vec<String>> {
        match kind {
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
}
