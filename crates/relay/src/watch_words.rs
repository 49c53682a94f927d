//! Encoding of lists of watched values and of the values: short, because they go in small datagrams.

use rafcon_link::{VALUE_BYTES_MAX, deflate, inflate};
use rafcon_protocol::{LongValue, WATCHED_MAX, WatchKind, WatchTarget, WatchedValue};
use serde_json::Value;

/// Longest list after inflation, in bytes.
const WATCH_BYTES_MAX: usize = 256 << 10;

/// Maximum number of runs of a robot that are watched at a time.
pub(crate) const RUNS_MAX: usize = 64;

const KINDS: [(WatchKind, char); 5] = [
    (WatchKind::State, 's'),
    (WatchKind::Input, 'i'),
    (WatchKind::Output, 'o'),
    (WatchKind::ScopedVariable, 'v'),
    (WatchKind::Global, 'g'),
];

fn letter(kind: WatchKind) -> char {
    KINDS.iter().find(|(known, _)| *known == kind).map_or('s', |(_, letter)| *letter)
}

fn kind(letter: char) -> Option<WatchKind> {
    KINDS.iter().find(|(_, known)| *known == letter).map(|(kind, _)| *kind)
}

type TargetWords = (char, String, String, u8);

/// Encodes a list. An empty list has no bytes.
pub(crate) fn write_targets(targets: &[WatchTarget]) -> Vec<u8> {
    if targets.is_empty() {
        return Vec::new();
    }
    let words: Vec<_> = targets
        .iter()
        .map(|target| (letter(target.kind), &target.path, &target.name, target.priority))
        .collect();
    deflate(&serde_json::to_vec(&words).unwrap_or_default())
}

/// Parses a list. `None` if it is invalid.
pub(crate) fn read_targets(body: &[u8]) -> Option<Vec<WatchTarget>> {
    if body.is_empty() {
        return Some(Vec::new());
    }
    let words: Vec<TargetWords> = serde_json::from_slice(&inflate(body, WATCH_BYTES_MAX)?).ok()?;
    let target = |(letter, path, name, priority): TargetWords| {
        Some(WatchTarget { kind: kind(letter)?, path, name, priority })
    };
    words.into_iter().take(WATCHED_MAX).map(target).collect()
}

type ValueWords = (char, String, String, u64, u64, Option<Value>, Option<(String, u64, String)>);

/// Encodes a value for one datagram: whole if it is short, otherwise a view. `None` if its names alone are too long.
pub(crate) fn value(value: &WatchedValue) -> Option<Vec<u8>> {
    let words = |inside: Option<&Value>| {
        let WatchedValue { kind, path, name, sequence, t_ns, large, .. } = value;
        let large = large.as_ref().filter(|_| inside.is_none());
        let large = large.map(|it| (&it.type_name, it.bytes, it.hash.as_deref().unwrap_or("")));
        serde_json::to_vec(&(letter(*kind), path, name, sequence, t_ns, inside, large)).ok()
    };
    let fits = |bytes: &Vec<u8>| bytes.len() <= VALUE_BYTES_MAX;
    let whole = value.value.as_ref().and_then(|inside| words(Some(inside)).filter(fits));
    whole.or_else(|| words(None).filter(fits))
}

/// Parses a value. `None` if it is invalid.
pub(crate) fn read_value(bytes: &[u8]) -> Option<WatchedValue> {
    let words: ValueWords = serde_json::from_slice(bytes).ok()?;
    let (letter, path, name, sequence, t_ns, value, large) = words;
    let large = large.map(|(type_name, bytes, hash)| LongValue {
        type_name,
        bytes,
        hash: Some(hash).filter(|hash| !hash.is_empty()),
    });
    Some(WatchedValue { kind: kind(letter)?, path, name, sequence, t_ns, value, large })
}

#[cfg(test)]
mod tests {
    use super::{WATCH_BYTES_MAX, read_targets, read_value, value, write_targets};
    use expect_test::expect;
    use rafcon_protocol::{LongValue, WatchKind, WatchTarget, WatchedValue};

    #[test]
    fn a_wish_is_read_as_it_was_written() {
        let targets: Vec<_> = (0..40)
            .map(|nth| WatchTarget {
                kind: [WatchKind::State, WatchKind::Input, WatchKind::Global][nth % 3],
                path: format!("ROOTID/ABCDEF/GHIJ{nth:02}"),
                name: "pose".to_owned(),
                priority: 1,
            })
            .collect();
        let body = write_targets(&targets);
        assert!(body.len() < 400, "{} bytes", body.len());
        assert_eq!(read_targets(&body), Some(targets));
        assert_eq!(read_targets(&write_targets(&[])), Some(Vec::new()));
    }

    #[test]
    fn what_is_no_wish_is_none() {
        let bomb = rafcon_link::deflate(&vec![b' '; 1 << 20]);
        let unknown = rafcon_link::deflate(br#"[["x","R","n",0]]"#);
        for body in [&[1, 2, 3][..], &bomb, &unknown] {
            assert_eq!(read_targets(body), None);
        }
    }

    #[test]
    fn a_long_value_is_told_by_its_size() {
        let short = WatchedValue {
            kind: WatchKind::Input,
            path: "R/A".to_owned(),
            name: "pose".to_owned(),
            sequence: 7,
            t_ns: 1_000,
            value: Some(serde_json::json!([1, 2])),
            large: None,
        };
        let large = LongValue { type_name: "list".to_owned(), bytes: 900, hash: None };
        let text = Some(serde_json::Value::from("x".repeat(900)));
        let long = WatchedValue { value: text, large: Some(large), ..short.clone() };
        let endless = WatchedValue { path: "R/".repeat(400), ..short.clone() };
        let words: Vec<_> = [&short, &long].map(|it| value(it).unwrap()).to_vec();
        let said: Vec<_> = words.iter().map(|it| String::from_utf8_lossy(it)).collect();
        expect![[r#"
            ["i","R/A","pose",7,1000,[1,2],null]
            ["i","R/A","pose",7,1000,null,["list",900,""]]"#]]
        .assert_eq(&said.join("\n"));
        assert_eq!(read_value(&words[0]), Some(short));
        assert_eq!(read_value(&words[1]), Some(WatchedValue { value: None, ..long }));
        assert_eq!(value(&endless), None);
        assert_eq!(read_value(b"[1]"), None);
    }

    #[test]
    fn a_wish_that_inflates_to_more_than_it_may_is_none() {
        let body = |bytes: usize| {
            let rest = bytes - br#"[["s","","n",0]]"#.len();
            let path = "R".repeat(rest);
            rafcon_link::deflate(format!(r#"[["s","{path}","n",0]]"#).as_bytes())
        };
        assert_eq!(read_targets(&body(WATCH_BYTES_MAX)).map(|targets| targets.len()), Some(1));
        assert_eq!(read_targets(&body(WATCH_BYTES_MAX + 1)), None);
    }
}
