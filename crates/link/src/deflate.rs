//! Snapshots and machines in fewer bytes.

use flate2::{Compress, Compression, Decompress, FlushCompress, FlushDecompress, Status};

/// The bytes, deflated without a header (RFC 1951).
pub fn deflate(bytes: &[u8]) -> Vec<u8> {
    // Incompressible data grows by 5 bytes in 65,535.
    let mut out = Vec::with_capacity(bytes.len() + bytes.len() / 1_000 + 64);
    let mut compress = Compress::new(Compression::default(), false);
    let _in_one_go = compress.compress_vec(bytes, &mut out, FlushCompress::Finish);
    out
}

/// Inflates bytes. `None` if they are damaged or more than `max`.
pub fn inflate(bytes: &[u8], max: usize) -> Option<Vec<u8>> {
    let (mut decompress, mut out) =
        (Decompress::new(false), Vec::with_capacity(4 * bytes.len() + 64));
    loop {
        let used = usize::try_from(decompress.total_in()).ok()?;
        let rest = bytes.get(used..)?;
        match decompress.decompress_vec(rest, &mut out, FlushDecompress::Finish).ok()? {
            Status::StreamEnd => return (out.len() <= max).then_some(out),
            Status::Ok | Status::BufError if out.len() < out.capacity() => return None,
            Status::Ok | Status::BufError => out.reserve(out.len()),
        }
        if out.len() > max {
            return None;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{deflate, inflate};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_is_deflated_comes_back(
            bytes in prop::collection::vec(any::<u8>(), 0..3_000),
            times in 1..20_usize,
        ) {
            let bytes = bytes.repeat(times);
            prop_assert_eq!(inflate(&deflate(&bytes), 1 << 20), Some(bytes));
        }

        #[test]
        fn broken_bytes_are_refused_or_give_something_else(
            bytes in prop::collection::vec(any::<u8>(), 0..300),
        ) {
            let _anything = inflate(&bytes, 1 << 20);
        }
    }

    #[test]
    fn a_bomb_is_refused() {
        let bomb = deflate(&vec![0; 64 << 20]);
        assert!(bomb.len() < 100_000);
        assert_eq!(inflate(&bomb, 16 << 20), None);
        let short = deflate(&[0; 101]);
        assert_eq!(inflate(&short, 100), None);
        assert_eq!(inflate(&short, 101), Some(vec![0; 101]));
    }
}
