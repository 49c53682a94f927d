//! Paths as people write them in a config: quotes, `~`, `${VAR}`, relative ones. Knows text and the environment that it
//! is given.

use std::path::{Component, Path, PathBuf};

/// Looks up an environment variable. The program passes its own environment; a test passes any.
pub type Environment<'e> = dyn Fn(&str) -> Option<String> + 'e;

/// The path that `text` means: without quotes, `~` and variables replaced, relative to `base`, without `.` and `..`.
/// A variable that is not set stays as it is written, so that a message shows it.
pub fn clean_path(text: &str, base: &Path, environment: &Environment<'_>) -> PathBuf {
    let text = text.trim().trim_matches(['"', '\'']);
    let text = expand_variables(text, environment);
    let home = environment("HOME").filter(|_| text == "~" || text.starts_with("~/"));
    let path = match home {
        Some(home) => PathBuf::from(home).join(text.trim_start_matches(['~', '/'])),
        None => PathBuf::from(text),
    };
    without_dots(&base.join(path))
}

/// `${NAME}` and `$NAME`.
fn expand_variables(text: &str, environment: &Environment<'_>) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find('$') {
        out.push_str(&rest[..at]);
        let (name, length) = variable(&rest[at..]);
        match environment(name).filter(|_| !name.is_empty()) {
            Some(value) => out.push_str(&value),
            None => out.push_str(&rest[at..at + length]),
        }
        rest = &rest[at + length..];
    }
    out.push_str(rest);
    out
}

/// The name of the variable that `text` begins with (a `$`), and how many bytes it takes.
fn variable(text: &str) -> (&str, usize) {
    if let Some(inside) = text.strip_prefix("${")
        && let Some(end) = inside.find('}')
    {
        return (&inside[..end], end + 3);
    }
    let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let name = &text[1..];
    let end = name.find(|c| !is_name(c)).unwrap_or(name.len());
    (&name[..end], end + 1)
}

fn without_dots(path: &Path) -> PathBuf {
    let mut clean = PathBuf::new();
    for component in path.components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir if clean.file_name().is_some() => {
                clean.pop();
            }
            other => clean.push(other),
        }
    }
    clean
}
