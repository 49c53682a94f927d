//! Conversion of folders from and to text.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its files has failed")]

use std::fs;
use std::path::Path;

/// Creates files. Each begins with a line `== path`; its text follows.
pub fn make_files(dir: &Path, text: &str) {
    for file in text.split("== ").skip(1) {
        let (path, text) = file.split_once('\n').unwrap_or((file, ""));
        let path = dir.join(path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
}

/// All files below `dir`, sorted, by path. Those named in `shown` include their text.
pub fn show_files(dir: &Path, shown: &[&str]) -> String {
    let mut files = Vec::new();
    collect(dir, dir, &mut files);
    files.sort();
    let mut out = String::new();
    for path in files {
        out.push_str(&path);
        out.push('\n');
        if shown.iter().any(|name| path.ends_with(name)) {
            let bytes = fs::read(dir.join(&path)).unwrap();
            out.push_str(&String::from_utf8_lossy(&bytes));
            out.push('\n');
        }
    }
    out
}

fn collect(top: &Path, dir: &Path, files: &mut Vec<String>) {
    for entry in fs::read_dir(dir).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() && !path.is_symlink() {
            collect(top, &path, files);
        } else {
            files.push(path.strip_prefix(top).unwrap().to_string_lossy().into_owned());
        }
    }
}

/// All bytes below `dir`, for the detection of changes.
pub fn fingerprint(dir: &Path) -> Vec<(String, Vec<u8>)> {
    let mut files = Vec::new();
    collect(dir, dir, &mut files);
    files.sort();
    files
        .into_iter()
        .map(|path| (path.clone(), fs::read(dir.join(&path)).unwrap_or_default()))
        .collect()
}
