//! Writes the list of the files of the built page, which a release build embeds in compressed form. Knows where `cargo xtask
//! web` puts them. A debug build reads the folder at run time, so it embeds none.

use flate2::{Compression, write::GzEncoder};
use std::error::Error;
use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    let root = PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR").ok_or("no crate")?);
    let out = PathBuf::from(std::env::var_os("OUT_DIR").ok_or("no place to write to")?);
    let web = root.join("../../web");
    let page = web.join("dist");
    let is_release = std::env::var_os("PROFILE").is_some_and(|profile| profile == "release");
    println!("cargo:rerun-if-changed=build.rs");
    let mut list = String::from("&[\n");
    if is_release {
        // Cargo would rebuild this crate each time if it watched a folder that does not exist, so it watches the parent
        // folder.
        let watched = if page.is_dir() { &page } else { &web };
        println!("cargo:rerun-if-changed={}", watched.display());
        for file in files(&page)? {
            let name = file.strip_prefix(&page)?.to_string_lossy().replace('\\', "/");
            // A copy: the page may be rebuilt before the compiler reads it.
            let copy = out.join("page").join(&name);
            fs::create_dir_all(copy.parent().unwrap_or(&out))?;
            let plain = fs::read(&file)?;
            let packed = packed(&plain)?;
            let is_packed = packed.len() < plain.len();
            fs::write(&copy, if is_packed { packed } else { plain })?;
            let copy = copy.display().to_string();
            writeln!(list, "    ({name:?}, include_bytes!({copy:?}), {is_packed}),")?;
        }
    }
    list.push_str("]\n");
    Ok(fs::write(out.join("page.rs"), list)?)
}

/// Compresses as small as possible, because it happens once. Fonts and pictures are compressed already.
fn packed(plain: &[u8]) -> std::io::Result<Vec<u8>> {
    let mut packer = GzEncoder::new(Vec::new(), Compression::best());
    packer.write_all(plain)?;
    packer.finish()
}

/// All files below a folder, sorted by name. Empty if the folder does not exist.
fn files(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    if !folder.is_dir() {
        return Ok(Vec::new());
    }
    let entries = fs::read_dir(folder)?.map(|entry| Ok(entry?.path()));
    let mut entries = entries.collect::<std::io::Result<Vec<_>>>()?;
    entries.sort();
    let mut found = Vec::new();
    for entry in entries {
        if entry.is_dir() {
            found.extend(files(&entry)?);
        } else {
            found.push(entry);
        }
    }
    Ok(found)
}
