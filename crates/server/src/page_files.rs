//! The files of the page: embedded and compressed in a release build, read from their folder in a debug build. Knows names and
//! types of files; does not know the client.

use flate2::read::GzDecoder;
use std::borrow::Cow;
use std::io::Read as _;
use std::path::PathBuf;

/// Source of the page's files.
#[derive(Debug, Clone)]
pub enum PageFiles {
    /// Embedded in the program.
    Carried,
    /// A folder. It is read at each request, so a rebuilt page appears at once.
    Folder(PathBuf),
}

/// A file of the page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct PageFile {
    pub(crate) bytes: Cow<'static, [u8]>,
    /// True if the bytes are a gzip file.
    pub(crate) is_packed: bool,
    /// Value for the header `Content-Type`.
    pub(crate) kind: &'static str,
}

impl PageFile {
    /// Decompresses the file, for the rare client that does not accept gzip.
    pub(crate) fn unpacked(self) -> std::io::Result<Self> {
        if !self.is_packed {
            return Ok(self);
        }
        let mut bytes = Vec::new();
        GzDecoder::new(self.bytes.as_ref()).read_to_end(&mut bytes)?;
        Ok(Self { bytes: Cow::Owned(bytes), is_packed: false, kind: self.kind })
    }
}

/// The page as of the release build of this program: name, bytes, and the flag for gzip.
static CARRIED: &[(&str, &[u8], bool)] = include!(concat!(env!("OUT_DIR"), "/page.rs"));

impl Default for PageFiles {
    /// The source that fits the build profile.
    fn default() -> Self {
        if cfg!(debug_assertions) {
            return Self::Folder(PathBuf::from(concat!(
                env!("CARGO_MANIFEST_DIR"),
                "/../../web/dist"
            )));
        }
        Self::Carried
    }
}

impl PageFiles {
    /// The file of this name. `None` if the name is invalid, the type unknown, or the file missing.
    pub(crate) fn get(&self, name: &str) -> Option<PageFile> {
        let kind = kind(name)?;
        if !is_plain(name) {
            return None;
        }
        let (bytes, is_packed) = match self {
            Self::Carried => {
                let (_, bytes, is_packed) = CARRIED.iter().find(|file| file.0 == name)?;
                (Cow::Borrowed(*bytes), *is_packed)
            }
            Self::Folder(folder) => (Cow::Owned(std::fs::read(folder.join(name)).ok()?), false),
        };
        Some(PageFile { bytes, is_packed, kind })
    }

    /// HTML with the command that builds the page, shown if the page is missing.
    pub(crate) fn way(&self) -> &'static str {
        match self {
            Self::Carried => {
                "run <code>cargo xtask web</code>, build the program again, and start it"
            }
            Self::Folder(_) => "run <code>cargo xtask web</code> and reload",
        }
    }
}

/// True for a name in the page's folder or its `assets`, which cannot lead out of them.
fn is_plain(name: &str) -> bool {
    let name = name.strip_prefix("assets/").unwrap_or(name);
    let is_sign = |sign: char| sign.is_ascii_alphanumeric() || "-_.".contains(sign);
    !name.starts_with('.') && name.chars().all(is_sign)
}

/// The MIME type of the file, by its extension.
fn kind(name: &str) -> Option<&'static str> {
    Some(match name.rsplit_once('.')?.1 {
        "html" => "text/html; charset=utf-8",
        "js" => "text/javascript; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        "json" | "map" => "application/json",
        "svg" => "image/svg+xml",
        "png" => "image/png",
        "woff2" => "font/woff2",
        "woff" => "font/woff",
        "wasm" => "application/wasm",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::{PageFile, PageFiles};
    use flate2::{Compression, write::GzEncoder};
    use std::borrow::Cow;
    use std::io::Write as _;

    #[test]
    fn a_packed_file_is_unpacked_for_who_takes_nothing_else() {
        let mut packer = GzEncoder::new(Vec::new(), Compression::best());
        packer.write_all(b"let a = 1;").unwrap();
        let bytes = Cow::Owned(packer.finish().unwrap());
        let file = PageFile { bytes, is_packed: true, kind: "text/javascript" };
        let plain = file.unpacked().unwrap();
        assert_eq!((plain.bytes.as_ref(), plain.is_packed), (&b"let a = 1;"[..], false));
        assert_eq!(plain.clone().unpacked().unwrap(), plain);
    }

    #[test]
    fn nothing_but_the_pages_own_files_is_given() {
        let place = tempfile::tempdir().unwrap();
        let page = place.path().join("dist");
        std::fs::create_dir_all(page.join("assets/inner")).unwrap();
        for file in ["index.html", "assets/a-1_B.js", "assets/inner/b.js", ".c.js", "../d.js"] {
            std::fs::write(page.join(file), "x").unwrap();
        }
        let files = PageFiles::Folder(page);
        let kind = |name: &str| files.get(name).map(|file| file.kind);
        assert_eq!(kind("index.html"), Some("text/html; charset=utf-8"));
        assert_eq!(kind("assets/a-1_B.js"), Some("text/javascript; charset=utf-8"));
        for name in
            ["../d.js", "assets/../../d.js", "assets/inner/b.js", ".c.js", "", "none.js", "assets"]
        {
            assert_eq!(files.get(name), None, "{name}");
        }
    }
}
