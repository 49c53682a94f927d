//! Numbers and bytes of frames: numbers are LEB128, byte strings have their length before them.

/// Bytes that are not what they should be; what was read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a frame of the link is broken: {0}")]
pub struct BrokenFrame(pub(crate) &'static str);

/// Appends the number as LEB128.
pub fn write_number(mut number: u64, out: &mut Vec<u8>) {
    loop {
        let [bits, ..] = (number & 0x7f).to_le_bytes();
        number >>= 7;
        if number == 0 {
            return out.push(bits);
        }
        out.push(bits | 0x80);
    }
}

/// Length of the number in bytes.
pub(crate) fn number_length(number: u64) -> usize {
    (64 - (number | 1).leading_zeros() as usize).div_ceil(7)
}

/// Appends the bytes with their length.
pub(crate) fn write_bytes(bytes: &[u8], out: &mut Vec<u8>) {
    write_number(bytes.len() as u64, out);
    out.extend_from_slice(bytes);
}

/// Reads numbers and bytes from the beginning of a slice. Each function fails if the rest is too short or malformed.
#[derive(Debug)]
pub struct FrameReader<'b> {
    rest: &'b [u8],
}

impl<'b> FrameReader<'b> {
    /// A reader of all these bytes.
    pub fn new(bytes: &'b [u8]) -> Self {
        Self { rest: bytes }
    }

    /// Number of bytes that were not read.
    pub(crate) fn left(&self) -> usize {
        self.rest.len()
    }

    /// Takes what was not read.
    pub fn rest(self) -> &'b [u8] {
        self.rest
    }

    /// Reads one byte.
    pub fn byte(&mut self) -> Result<u8, BrokenFrame> {
        let (byte, rest) = self.rest.split_first().ok_or(BrokenFrame("it ends too early"))?;
        self.rest = rest;
        Ok(*byte)
    }

    /// Reads an LEB128 number.
    pub fn number(&mut self) -> Result<u64, BrokenFrame> {
        let mut number = 0_u64;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            let bits = u64::from(byte & 0x7f);
            if shift == 63 && bits > 1 {
                break;
            }
            number |= bits << shift;
            if byte < 0x80 {
                return Ok(number);
            }
        }
        Err(BrokenFrame("a number is too large"))
    }

    pub(crate) fn small(&mut self) -> Result<u32, BrokenFrame> {
        u32::try_from(self.number()?).map_err(|_large| BrokenFrame("a number is too large"))
    }

    /// Reads this many bytes.
    pub fn fixed<const N: usize>(&mut self) -> Result<[u8; N], BrokenFrame> {
        let (bytes, rest) =
            self.rest.split_first_chunk::<N>().ok_or(BrokenFrame("it ends too early"))?;
        self.rest = rest;
        Ok(*bytes)
    }

    /// Reads bytes that have their length before them.
    pub fn bytes(&mut self) -> Result<&'b [u8], BrokenFrame> {
        let length = usize::try_from(self.number()?).unwrap_or(usize::MAX);
        let (bytes, rest) =
            self.rest.split_at_checked(length).ok_or(BrokenFrame("it ends too early"))?;
        self.rest = rest;
        Ok(bytes)
    }
}
