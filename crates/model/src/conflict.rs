//! Conflict markers that a merge of version control leaves in a text. Pure.

/// The remedy for a text with conflict markers.
pub const CONFLICT_REMEDY: &str = "keep one version of each part, and remove the lines that begin with <<<<<<<, ======= and >>>>>>>";

/// The line of the first conflict marker in a text that does not parse, from 1. A text that parses may quote such lines.
pub fn conflict_line(text: &str) -> Option<u64> {
    let is_marker = |line: &str| {
        ["<<<<<<<", ">>>>>>>"].iter().any(|marker| {
            line.strip_prefix(marker).is_some_and(|rest| rest.is_empty() || rest.starts_with(' '))
        })
    };
    (1..).zip(text.lines()).find(|(_, line)| is_marker(line)).map(|(number, _)| number)
}

#[cfg(test)]
mod tests {
    use super::conflict_line;

    #[test]
    fn the_first_marker_is_found() {
        assert_eq!(conflict_line("{\n<<<<<<< HEAD\n=======\n>>>>>>> other\n}"), Some(2));
        assert_eq!(conflict_line("a = 1\r\n>>>>>>> other\r\n"), Some(2));
        assert_eq!(conflict_line("<<<<<<<\n"), Some(1));
    }

    #[test]
    fn other_lines_are_no_markers() {
        assert_eq!(conflict_line("Title\n=======\n\nx <<<<<<< y\n<<<<<<<<<< bits\n"), None);
    }
}
