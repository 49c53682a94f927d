//! Texts of several lines inside the notation: scripts and descriptions, indented below their keyword.

/// The lines of a document, taken from front to back.
pub(super) struct Lines<'t> {
    lines: Vec<&'t str>,
    next: usize,
}

impl<'t> Lines<'t> {
    pub(super) fn new(text: &'t str) -> Self {
        let strip = |line: &'t str| line.strip_suffix('\r').unwrap_or(line);
        Self { lines: text.split('\n').map(strip).collect(), next: 0 }
    }

    /// The number of the next line, counted from 1, and the line.
    pub(super) fn take(&mut self) -> Option<(usize, &'t str)> {
        let line = self.lines.get(self.next)?;
        self.next += 1;
        Some((self.next, line))
    }

    /// The lines below a keyword at `indent` that are indented deeper, without their common indentation, which is that of
    /// the first. Empty lines at the end belong to nobody.
    pub(super) fn block(&mut self, indent: usize) -> String {
        let rest = &self.lines[self.next..];
        let inside = |line: &&str| is_blank(line) || indent_of(line) > indent;
        let count = rest.iter().take_while(|line| inside(line)).count();
        let filled = rest[..count].iter().rposition(|line| !is_blank(line)).map_or(0, |at| at + 1);
        let block = &rest[..filled];
        let margin = block.iter().find(|line| !is_blank(line)).map_or(0, |line| indent_of(line));
        let cut = |line: &&'t str| &line[margin.min(indent_of(line))..];
        self.next += filled;
        block.iter().map(cut).collect::<Vec<_>>().join("\n")
    }
}

fn is_blank(line: &str) -> bool {
    indent_of(line) == line.len()
}

fn indent_of(line: &str) -> usize {
    line.len() - line.trim_start_matches([' ', '\t']).len()
}
