//! Valid ids of runs. An id may come from another computer. It must stay inside the folder of all runs, and be displayed unaltered
//! in lists, command lines and the page.

/// Maximum length of an id in bytes.
pub const RUN_ID_MAX: usize = 128;
/// Suffix of a folder that is being deleted.
pub(in crate::journal) const GONE: &str = ".gone";
/// Reserved word for the newest run.
const LAST: &str = "last";

/// Reason why a text is not a valid id of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum BadRunId {
    /// The text is empty.
    #[error("the id of a run is empty")]
    Empty,
    /// The text is too long for the name of a folder.
    #[error("the id of a run has {0} bytes, and at most {RUN_ID_MAX} are allowed")]
    Long(usize),
    /// The text is not a plain file name.
    #[error("the id of a run begins with `-` or `.`, or has a `/`")]
    Path,
    /// The text has invisible characters, or characters that change how a line is displayed.
    #[error("the id of a run has control characters or marks of writing direction")]
    Invisible,
    /// The text is a reserved word.
    #[error("the id of a run is `{LAST}` or ends with `{GONE}`, which mean something else")]
    Reserved,
}

/// Checks the id of a run from any source.
pub fn check_run_id(id: &str) -> Result<(), BadRunId> {
    // Direction marks, joiners and other format characters of Unicode.
    let is_format = |letter: char| {
        matches!(letter,
            '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}'
            | '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}')
    };
    if id.is_empty() {
        Err(BadRunId::Empty)
    } else if id.len() > RUN_ID_MAX {
        Err(BadRunId::Long(id.len()))
    } else if id.starts_with(['-', '.']) || id.contains('/') {
        Err(BadRunId::Path)
    } else if id.contains(|letter: char| letter.is_control() || is_format(letter)) {
        Err(BadRunId::Invisible)
    } else if id == LAST || id.ends_with(GONE) {
        Err(BadRunId::Reserved)
    } else {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{BadRunId, RUN_ID_MAX, check_run_id};
    use crate::journal::folder::run_id;

    #[test]
    fn an_id_is_a_plain_name() {
        let longest = run_id(u64::MAX / 2, &"x".repeat(90), u16::MAX);
        for id in
            [longest.as_str(), "a run with spaces", "Fahrt über Sand", &"x".repeat(RUN_ID_MAX)]
        {
            assert_eq!(check_run_id(id), Ok(()), "{id}");
        }
        for (id, why) in [
            ("", BadRunId::Empty),
            (&"x".repeat(RUN_ID_MAX + 1), BadRunId::Long(RUN_ID_MAX + 1)),
            ("../x", BadRunId::Path),
            ("a/b", BadRunId::Path),
            (".", BadRunId::Path),
            ("-rf", BadRunId::Path),
            ("a\nb", BadRunId::Invisible),
            ("a\0b", BadRunId::Invisible),
            ("\u{1b}[2J", BadRunId::Invisible),
            ("a\u{202e}b", BadRunId::Invisible),
            ("a\u{200b}b", BadRunId::Invisible),
            ("last", BadRunId::Reserved),
            ("a.gone", BadRunId::Reserved),
        ] {
            assert_eq!(check_run_id(id), Err(why), "{id:?}");
        }
    }
}
