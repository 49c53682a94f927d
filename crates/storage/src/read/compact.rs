//! Removes the white space between the parts of a JSON text. Parses only strings and brackets.

/// Appends `text` without white space outside strings. `None` if brackets do not match or a string does not end, so that a
/// truncated document is detected without parsing all of it.
pub(crate) fn compact(text: &str, out: &mut String) -> Option<()> {
    let bytes = text.as_bytes();
    let mut open = 0_usize;
    let mut from = 0;
    let mut at = 0;
    while let Some(byte) = bytes.get(at) {
        match byte {
            b'"' => at = end_of_string(bytes, at)?,
            b'{' | b'[' => open += 1,
            b'}' | b']' => open = open.checked_sub(1)?,
            b' ' | b'\n' | b'\r' | b'\t' => {
                out.push_str(&text[from..at]);
                at = end_of_space(bytes, at);
                from = at;
                continue;
            }
            _ => {}
        }
        at += 1;
    }
    out.push_str(&text[from..]);
    (open == 0).then_some(())
}

/// The index of the quote that ends the string which begins at `start`.
fn end_of_string(bytes: &[u8], start: usize) -> Option<usize> {
    let mut at = start + 1;
    loop {
        match bytes.get(at)? {
            b'"' => return Some(at),
            b'\\' => at += 2,
            _ => at += 1,
        }
    }
}

fn end_of_space(bytes: &[u8], start: usize) -> usize {
    let rest = &bytes[start..];
    start + rest.iter().take_while(|b| matches!(b, b' ' | b'\n' | b'\r' | b'\t')).count()
}

#[cfg(test)]
mod tests {
    use super::compact;
    use expect_test::{Expect, expect};

    fn check(text: &str, expect: &Expect) {
        let mut out = String::new();
        let done = compact(text, &mut out);
        expect.assert_eq(&format!("{} {out}", if done.is_some() { "ok" } else { "broken" }));
    }

    #[test]
    fn white_space_goes_and_strings_stay() {
        check(
            "{\n  \"a b\": [1, \n 2], \"\\\" c\": \" ü \"\n}\n",
            &expect![[r#"ok {"a b":[1,2],"\" c":" ü "}"#]],
        );
    }

    #[test]
    fn a_truncated_text_is_noticed() {
        check("{\"a\": [1", &expect![[r#"broken {"a":[1"#]]);
        check("{\"a", &expect!["broken "]);
        check("{\"a\\", &expect!["broken "]);
        check("}{", &expect!["broken "]);
    }
}
