//! The payload of a datagram while it is written: the time of the sender, then frames up to a limit.

use crate::bytes::write_number;
use crate::frame::Frame;
use crate::session_time::SessionTime;

/// A payload that grows frame by frame up to its limit.
#[derive(Debug)]
pub(crate) struct PayloadWriter {
    bytes: Vec<u8>,
    bytes_max: usize,
    /// Kinds and lengths of the frames.
    frames: Vec<(&'static str, usize)>,
}

impl PayloadWriter {
    /// A payload of at most this many bytes that is sent now.
    pub(crate) fn new(now: SessionTime, bytes_max: usize) -> Self {
        let mut bytes = Vec::with_capacity(bytes_max);
        write_number(now.as_millis(), &mut bytes);
        Self { bytes, bytes_max, frames: Vec::new() }
    }

    /// Appends a frame that was made to fit into what is left.
    pub(crate) fn fitting_frame(&mut self, frame: &Frame<'_>) {
        let fits = self.try_frame(frame);
        debug_assert!(fits, "a frame exceeds the datagram");
    }

    /// Appends a frame if it fits.
    pub(crate) fn try_frame(&mut self, frame: &Frame<'_>) -> bool {
        self.try_frames_leaving(0, [frame])
    }

    /// Appends a frame if it fits and leaves this many bytes.
    pub(crate) fn try_frame_leaving(&mut self, rest: usize, frame: &Frame<'_>) -> bool {
        self.try_frames_leaving(rest, [frame])
    }

    /// Appends these frames if all of them fit.
    pub(crate) fn try_frames<'f>(
        &mut self,
        frames: impl IntoIterator<Item = &'f Frame<'f>>,
    ) -> bool {
        self.try_frames_leaving(0, frames)
    }

    fn try_frames_leaving<'f>(
        &mut self,
        rest: usize,
        frames: impl IntoIterator<Item = &'f Frame<'f>>,
    ) -> bool {
        let (length, count) = (self.bytes.len(), self.frames.len());
        for frame in frames {
            let begin = self.bytes.len();
            frame.write(&mut self.bytes);
            self.frames.push((frame.kind(), self.bytes.len() - begin));
        }
        let fits = self.bytes.len() + rest <= self.bytes_max;
        if !fits {
            self.bytes.truncate(length);
            self.frames.truncate(count);
        }
        fits
    }

    /// True if no frame was written.
    pub(crate) fn is_empty(&self) -> bool {
        self.frames.is_empty()
    }

    /// Length of the payload in bytes.
    pub(crate) fn len(&self) -> usize {
        self.bytes.len()
    }

    /// Limit of the payload in bytes.
    pub(crate) fn bytes_max(&self) -> usize {
        self.bytes_max
    }

    /// Bytes that are left for further frames.
    pub(crate) fn left(&self) -> usize {
        self.bytes_max.saturating_sub(self.bytes.len())
    }

    /// The payload, with the frames up to now.
    pub(crate) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Kinds and lengths of the frames.
    pub(crate) fn frames(&self) -> &[(&'static str, usize)] {
        &self.frames
    }
}

#[cfg(test)]
mod tests {
    use super::PayloadWriter;
    use crate::frame::Frame;
    use crate::session_time::SessionTime;

    #[test]
    fn frames_that_do_not_fit_leave_nothing_behind() {
        let frame = Frame::Calendar { began_ms: 7 };
        let mut payload = PayloadWriter::new(SessionTime::from_millis(1), 4);
        assert!(payload.is_empty() && payload.try_frame(&frame));
        assert!(!payload.try_frame(&frame));
        assert_eq!((payload.len(), payload.left(), payload.frames().len()), (3, 1, 1));
        let mut payload = PayloadWriter::new(SessionTime::from_millis(1), 4);
        assert!(!payload.try_frames([&frame, &frame]));
        assert!(payload.is_empty());
        assert_eq!(payload.bytes(), [1]);
    }
}
