//! Every datagram that was sent, in a file: a byte that says from whom, the time in ms, the length, the bytes.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write as _};
use std::path::Path;
use std::time::Duration;

/// Who sent it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Recorded {
    FromRobot,
    FromStation,
}

/// A file that is being written.
pub(crate) struct Recording(BufWriter<File>);

impl Recording {
    pub(crate) fn create(file: &Path) -> io::Result<Self> {
        Ok(Self(BufWriter::new(File::create(file)?)))
    }

    pub(crate) fn add(&mut self, now: Duration, from: Recorded, datagram: &[u8]) -> io::Result<()> {
        let from = match from {
            Recorded::FromRobot => b'D',
            Recorded::FromStation => b'U',
        };
        let ms = u64::try_from(now.as_millis()).unwrap_or(u64::MAX);
        let length = u32::try_from(datagram.len()).unwrap_or(u32::MAX);
        self.0.write_all(&[from])?;
        self.0.write_all(&ms.to_be_bytes())?;
        self.0.write_all(&length.to_be_bytes())?;
        self.0.write_all(datagram)?;
        self.0.flush()
    }
}

/// All datagrams of a recording, in their order. What is cut off at its end is left out.
pub(crate) fn read(file: &Path) -> io::Result<Vec<(Recorded, Vec<u8>)>> {
    let bytes = fs::read(file)?;
    let (mut rest, mut found) = (bytes.as_slice(), Vec::new());
    while let Some((head, more)) = rest.split_first_chunk::<13>() {
        let [from, _, _, _, _, _, _, _, _, length @ ..] = *head;
        let length = usize::try_from(u32::from_be_bytes(length)).unwrap_or(usize::MAX);
        let Some((datagram, more)) = more.split_at_checked(length) else { break };
        let from = if from == b'D' { Recorded::FromRobot } else { Recorded::FromStation };
        found.push((from, datagram.to_vec()));
        rest = more;
    }
    Ok(found)
}
