//! Paths as people write them in a config: quotes, `~`, `${VAR}`, relative ones. Uses only the environment that it receives.

use std::path::{Component, Path, PathBuf};

/// Looks up an environment variable. The program passes its own environment; a test passes any.
pub type Environment<'e> = dyn Fn(&str) -> Option<String> + 'e;

/// Returns the path that `text` describes: without quotes, `~` and variables replaced, relative to `base`, without `.` and `..`. An
/// undefined variable is not replaced, so that a message shows it.
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

/// Replaces variables written `${NAME}` or `$NAME`.
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

/// Returns the name of the variable at the start of `text` (a `$`), and its length in bytes.
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
