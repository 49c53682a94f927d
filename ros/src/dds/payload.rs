//! Messages in DDS: bytes of CDR, passed unchanged.

use std::convert::Infallible;

use rustdds::RepresentationIdentifier;
use rustdds::bytes::Bytes;
use rustdds::no_key::{Decode, DefaultDecoder, DeserializerAdapter, SerializerAdapter};

/// A message in CDR.
#[derive(Clone, Debug)]
pub(crate) struct Payload {
    pub(crate) bytes: Bytes,
    /// True for little-endian numbers.
    pub(crate) little: bool,
}

/// The byte order of this computer.
const OWN: RepresentationIdentifier = if cfg!(target_endian = "little") {
    RepresentationIdentifier::CDR_LE
} else {
    RepresentationIdentifier::CDR_BE
};

/// Passes bytes on in both directions.
pub(crate) struct Plain;

impl SerializerAdapter<Payload> for Plain {
    type Error = Infallible;

    fn output_encoding() -> RepresentationIdentifier {
        OWN
    }

    fn to_bytes(value: &Payload) -> Result<Bytes, Infallible> {
        Ok(value.bytes.clone())
    }
}

impl DeserializerAdapter<Payload> for Plain {
    type Error = Infallible;
    type Decoded = Payload;

    fn supported_encodings() -> &'static [RepresentationIdentifier] {
        &[RepresentationIdentifier::CDR_LE, RepresentationIdentifier::CDR_BE]
    }

    fn transform_decoded(decoded: Payload) -> Payload {
        decoded
    }
}

impl DefaultDecoder<Payload> for Plain {
    type Decoder = PlainDecoder;
    const DECODER: PlainDecoder = PlainDecoder;
}

/// Decoder that copies the bytes of a message.
#[derive(Clone)]
pub(crate) struct PlainDecoder;

impl<'de> Decode<'de, Payload> for PlainDecoder {
    type Error = Infallible;

    fn decode_bytes(
        self,
        bytes: &'de [u8],
        encoding: RepresentationIdentifier,
    ) -> Result<Payload, Infallible> {
        let little = encoding == RepresentationIdentifier::CDR_LE;
        Ok(Payload { bytes: Bytes::copy_from_slice(bytes), little })
    }
}
