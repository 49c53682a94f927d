//! The text of a script, as Python reads source files: without a byte order mark, and decoded by the encoding that one of its
//! first two lines declares (PEP 263), if it is not UTF-8.

use encoding_rs::Encoding;
use std::borrow::Cow;

const BYTE_ORDER_MARK: char = '\u{feff}';
/// Names of the encoding whose bytes are the first code points.
const LATIN_1: [&str; 6] = ["latin-1", "latin1", "iso-8859-1", "iso8859-1", "l1", "cp819"];

/// Returns the text, and true if it differs from the file's bytes. `None` if it cannot be decoded.
pub(super) fn decode(bytes: &[u8]) -> Option<(Cow<'_, str>, bool)> {
    if let Ok(text) = std::str::from_utf8(bytes) {
        let plain = text.strip_prefix(BYTE_ORDER_MARK);
        return Some((Cow::Borrowed(plain.unwrap_or(text)), plain.is_some()));
    }
    let name = declared(bytes)?.to_ascii_lowercase().replace('_', "-");
    if LATIN_1.contains(&name.as_str()) {
        return Some((bytes.iter().copied().map(char::from).collect::<String>().into(), true));
    }
    let encoding = Encoding::for_label(name.as_bytes())?;
    let text = encoding.decode_without_bom_handling_and_without_replacement(bytes)?;
    Some((text, true))
}

/// The name of the declared encoding.
fn declared(bytes: &[u8]) -> Option<String> {
    let mut lines = bytes.split(|&byte| byte == b'\n').take(2).map(String::from_utf8_lossy);
    let first = lines.next()?;
    if let Some(name) = coding(&first) {
        return Some(name);
    }
    let is_empty = first.trim_start().is_empty() || first.trim_start().starts_with('#');
    is_empty.then(|| lines.next().as_deref().and_then(coding)).flatten()
}

/// The name behind `coding:` or `coding=` in a comment.
fn coding(line: &str) -> Option<String> {
    let comment = line.trim_start().strip_prefix('#')?;
    comment.match_indices("coding").find_map(|(at, word)| {
        let rest = comment.get(at + word.len()..)?.strip_prefix([':', '='])?;
        let rest = rest.trim_start_matches([' ', '\t']);
        let is_name = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
        let end = rest.find(|c| !is_name(c)).unwrap_or(rest.len());
        rest.get(..end).filter(|name| !name.is_empty()).map(str::to_owned)
    })
}

#[cfg(test)]
mod tests {
    use super::decode;

    fn check(bytes: &[u8], expected: Option<(&str, bool)>) {
        let found = decode(bytes);
        assert_eq!(found.as_ref().map(|(text, is_other)| (&**text, *is_other)), expected);
    }

    #[test]
    fn utf_8_needs_no_declaration() {
        check("# é\n".as_bytes(), Some(("# é\n", false)));
        check("# coding: latin-1\n# é\n".as_bytes(), Some(("# coding: latin-1\n# é\n", false)));
    }

    #[test]
    fn a_byte_order_mark_is_left_out() {
        check(b"\xef\xbb\xbfx = 1\n", Some(("x = 1\n", true)));
    }

    #[test]
    fn a_declaration_in_the_first_two_lines_counts() {
        check(
            b"# -*- coding: latin-1 -*-\n# \xe9\x80\n",
            Some(("# -*- coding: latin-1 -*-\n# é\u{80}\n", true)),
        );
        check(
            b"#!/usr/bin/python\n# vim: set fileencoding=cp1252 :\n# \x80\n",
            Some(("#!/usr/bin/python\n# vim: set fileencoding=cp1252 :\n# €\n", true)),
        );
        check(b"\n#coding=ISO_8859-15\n# \xa4\n", Some(("\n#coding=ISO_8859-15\n# €\n", true)));
        check(b"# coding: shift_jis\n# \x82\xa0\n", Some(("# coding: shift_jis\n# あ\n", true)));
    }

    #[test]
    fn anything_else_cannot_be_decoded() {
        check(b"# \xe9\n", None);
        check(b"x = 1\n# coding: latin-1\n# \xe9\n", None);
        check(b"# coding: nonsense\n# \xe9\n", None);
        check(b"# coding: utf-8\n# \xe9\n", None);
        check(b"# coding: shift_jis\n# \xff\n", None);
    }
}
