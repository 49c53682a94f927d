//! Lines of styled text: width, truncation, and rendering with and without colour.

use std::fmt::Write as _;
use unicode_width::UnicodeWidthStr as _;

/// Appearance of a piece of text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Style {
    /// Default style of the terminal.
    Plain,
    /// Less important than plain text.
    Dim,
    /// More important than plain text.
    Strong,
    /// Success, green on a terminal.
    Good,
    /// Needs attention, yellow on a terminal.
    Warning,
    /// Failure, red on a terminal.
    Bad,
}

impl Style {
    fn code(self) -> Option<&'static str> {
        match self {
            Self::Plain => None,
            Self::Dim => Some("2"),
            Self::Strong => Some("1"),
            Self::Good => Some("32"),
            Self::Warning => Some("33"),
            Self::Bad => Some("31"),
        }
    }
}

/// Capabilities of the output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Paint {
    /// Colours and weights, by escape sequences.
    pub(crate) colour: bool,
    /// Characters beyond ASCII for pictures.
    pub(crate) unicode: bool,
}

#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct TextLine {
    pieces: Vec<(Style, String)>,
}

impl TextLine {
    /// A line with one piece.
    pub(crate) fn of(style: Style, text: impl Into<String>) -> Self {
        Self::default().and(style, text)
    }

    /// Adds a piece at the end.
    #[must_use]
    pub(crate) fn and(mut self, style: Style, text: impl Into<String>) -> Self {
        self.pieces.push((style, text.into()));
        self
    }

    /// Adds another line at the end.
    #[must_use]
    pub(crate) fn followed_by(mut self, mut other: Self) -> Self {
        self.pieces.append(&mut other.pieces);
        self
    }

    /// Width in columns of a terminal.
    pub(crate) fn width(&self) -> usize {
        self.pieces.iter().map(|(_, text)| text.width()).sum()
    }

    /// Adds `right` at the right border of `width` columns; the left part is truncated if necessary.
    #[must_use]
    pub(crate) fn with_right(self, right: Self, width: usize) -> Self {
        self.with_right_after(' ', right, width)
    }

    /// Adds `right` like this, with the space between both filled by `fill`, a character of one column.
    #[must_use]
    pub(crate) fn with_right_after(self, fill: char, right: Self, width: usize) -> Self {
        let room = width.saturating_sub(right.width());
        let mut line = self.cut(room.saturating_sub(1));
        let gap = room.saturating_sub(line.width());
        let filling = match gap {
            0 | 1 => " ".repeat(gap),
            _ => format!(" {} ", fill.to_string().repeat(gap - 2)),
        };
        line.pieces.push((Style::Dim, filling));
        line.pieces.extend(right.pieces);
        line.cut(width)
    }

    /// Truncates the line to `width` columns, with an ellipsis.
    #[must_use]
    pub(crate) fn cut(self, width: usize) -> Self {
        if self.width() <= width {
            return self;
        }
        let mut room = width.saturating_sub(1);
        let mut pieces = Vec::new();
        for (style, text) in self.pieces {
            let kept = prefix(&text, room);
            room -= kept.width();
            let complete = kept.len() == text.len();
            pieces.push((style, kept.to_owned()));
            if !complete {
                break;
            }
        }
        if width > 0 {
            pieces.push((Style::Dim, "…".to_owned()));
        }
        Self { pieces }
    }

    /// The line as text with escape sequences.
    pub(crate) fn render(&self, paint: Paint) -> String {
        let mut text = String::new();
        for (style, piece) in &self.pieces {
            match style.code().filter(|_| paint.colour && !piece.is_empty()) {
                Some(code) => write!(text, "\x1b[{code}m{piece}\x1b[0m").unwrap_or_default(),
                None => text.push_str(piece),
            }
        }
        if paint.unicode { text } else { text.replace('…', "~") }
    }
}

/// The longest prefix of `text` that fits in `width` columns. It is measured as a whole, because a character may widen the
/// one before it.
fn prefix(text: &str, width: usize) -> &str {
    let ends = text.char_indices().map(|(index, c)| index + c.len_utf8());
    let fitting = ends.take_while(|end| text[..*end].width() <= width);
    &text[..fitting.last().unwrap_or(0)]
}

/// Text that is safe for a terminal: control characters become visible, tabs become spaces.
pub(crate) fn harmless(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\t' => out.push_str("    "),
            c if c.is_control() => out.extend(c.escape_default()),
            c => out.push(c),
        }
    }
    out
}

/// A duration for people: `0.4 s`, `12.3 s`, `2:05`, `1:02:05`.
pub(crate) fn time(time: std::time::Duration) -> String {
    let seconds = time.as_secs();
    match (seconds / 3600, seconds / 60 % 60, seconds % 60) {
        (0, 0, _) => format!("{:.1} s", time.as_secs_f64()),
        (0, minutes, seconds) => format!("{minutes}:{seconds:02}"),
        (hours, minutes, seconds) => format!("{hours}:{minutes:02}:{seconds:02}"),
    }
}

/// A number of bytes for people.
#[expect(clippy::cast_precision_loss, reason = "one digit after the point is shown")]
pub(crate) fn size(bytes: u64) -> String {
    const UNITS: [&str; 5] = ["B", "KB", "MB", "GB", "TB"];
    let mut size = bytes as f64;
    let mut unit = 0;
    while size >= 999.5 && unit + 1 < UNITS.len() {
        (size, unit) = (size / 1000.0, unit + 1);
    }
    if unit == 0 || size >= 99.5 {
        format!("{size:.0} {}", UNITS[unit])
    } else {
        format!("{size:.1} {}", UNITS[unit])
    }
}

/// A count with its noun: `no states`, `1 state`, `1,234,567 states`.
pub(crate) fn counted(number: u64, thing: &str) -> String {
    match number {
        0 => format!("no {thing}s"),
        1 => format!("1 {thing}"),
        _ => format!("{} {thing}s", grouped(number)),
    }
}

/// A number in groups of three digits.
fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let groups = digits.as_bytes().rchunks(3).rev();
    let groups = groups.map(|group| String::from_utf8_lossy(group).into_owned());
    groups.collect::<Vec<_>>().join(",")
}

#[cfg(test)]
mod tests {
    use super::{Paint, Style, TextLine, counted, harmless, time};
    use proptest::prelude::*;
    use std::time::Duration;

    const PLAIN: Paint = Paint { colour: false, unicode: true };

    fn check(line: TextLine, width: usize, expected: &str) {
        let line = line.cut(width);
        assert!(line.width() <= width);
        assert_eq!(line.render(PLAIN), expected);
    }

    #[test]
    fn a_line_is_cut_by_columns_and_not_by_bytes() {
        check(TextLine::of(Style::Plain, "prüfen"), 6, "prüfen");
        check(TextLine::of(Style::Plain, "prüfen"), 5, "prüf…");
        check(TextLine::of(Style::Plain, "日本語"), 5, "日本…");
        check(TextLine::of(Style::Plain, "日本語"), 4, "日…");
        check(TextLine::of(Style::Dim, "ab").and(Style::Plain, "cdef"), 4, "abc…");
        check(TextLine::of(Style::Plain, "ab"), 0, "");
    }

    proptest! {
        #[test]
        fn no_line_is_wider_than_its_place(parts: Vec<String>, width in 0_usize..50) {
            let line = parts.iter().fold(TextLine::default(), |line, text| line.and(Style::Plain, harmless(text)));
            prop_assert!(line.clone().cut(width).width() <= width);
            let right = TextLine::of(Style::Dim, "12.3 s");
            prop_assert!(line.with_right(right, width).width() <= width);
        }

        #[test]
        fn nothing_controls_the_terminal(text: String) {
            prop_assert!(!harmless(&text).contains(char::is_control));
        }
    }

    #[test]
    fn the_right_part_stays_when_there_is_no_room() {
        let line = TextLine::of(Style::Plain, "a long name")
            .with_right(TextLine::of(Style::Dim, "1 s"), 10);
        assert_eq!(line.render(PLAIN), "a lon… 1 s");
    }

    #[test]
    fn colour_is_only_where_it_is_wanted() {
        let line = TextLine::of(Style::Bad, "no").and(Style::Plain, " way");
        let paint = Paint { colour: true, unicode: true };
        assert_eq!(line.render(paint), "\x1b[31mno\x1b[0m way");
        assert_eq!(line.render(PLAIN), "no way");
    }

    #[test]
    fn a_script_cannot_move_the_cursor() {
        assert_eq!(harmless("a\x1b[2Jb\tc"), "a\\u{1b}[2Jb    c");
    }

    #[test]
    fn times_and_counts_are_for_people() {
        let times = [400, 12_345, 125_000, 3_725_000].map(Duration::from_millis).map(time);
        assert_eq!(times, ["0.4 s", "12.3 s", "2:05", "1:02:05"]);
        let counts = [0, 1, 7, 1_234, 1_234_567].map(|number| counted(number, "state"));
        let expected = ["no states", "1 state", "7 states", "1,234 states", "1,234,567 states"];
        assert_eq!(counts, expected);
    }

    #[test]
    fn sizes_are_for_people() {
        let sizes = [0, 999, 1000, 25_300_000, 999_600_000, 20 << 30].map(super::size);
        assert_eq!(sizes, ["0 B", "999 B", "1.0 KB", "25.3 MB", "1.0 GB", "21.5 GB"]);
    }
}
