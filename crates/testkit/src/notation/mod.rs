//! Parser for machines as text, the counterpart of [`rafcon_model::notation`], which prints them. Parses line by line, with
//! a stack of open blocks instead of recursion. Knows the syntax of `docs/notation.md`; never files.

mod connect;
mod draft;
mod scan;

#[cfg(test)]
mod tests;

pub use rafcon_model::notation::{Shown, print, print_with};

use draft::{Draft, read_layout};
use rafcon_model::{Header, Machine, State};
use scan::{Line, Lines};
use smol_str::SmolStr;
use std::collections::BTreeMap;
use std::sync::Arc;

/// An error in a text, with its position.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {line}, column {column}: {reason}")]
pub struct NotationError {
    /// Line of the text, counted from 1.
    pub line: usize,
    /// Counted from 1, in bytes.
    pub column: usize,
    /// Description of the problem.
    pub reason: String,
}

/// Parses a machine. Faults of the machine (transitions to nowhere, duplicate names) are no errors here.
pub fn parse(text: &str) -> Result<Machine, NotationError> {
    let mut parser = NotationParser {
        lines: Lines::new(text),
        open: Vec::new(),
        header: Header::default(),
        root: None,
        defined: BTreeMap::new(),
    };
    let mut last = 1;
    while let Some((number, line)) = parser.lines.take() {
        last = number;
        let mut line = Line::new(number, line);
        if !line.at_end() {
            parser.close(line.indent)?;
            parser.line(line)?;
        }
    }
    parser.close(0)?;
    match parser.root {
        Some(root) => Ok(Machine { header: parser.header, root }),
        None => Err(Line::new(last, "").error("there is no state")),
    }
}

struct NotationParser<'t> {
    lines: Lines<'t>,
    open: Vec<Block<'t>>,
    header: Header,
    root: Option<Arc<State>>,
    defined: BTreeMap<SmolStr, Arc<State>>,
}

struct Block<'t> {
    line: Line<'t>,
    open: Open<'t>,
}

enum Open<'t> {
    Header,
    State(Box<Draft<'t>>),
    Content,
    Define(SmolStr),
}

const KINDS: [&str; 6] = ["execution", "decider", "hierarchy", "barrier", "preemptive", "library"];

impl<'t> NotationParser<'t> {
    /// Closes the blocks that do not contain a line at `indent`.
    fn close(&mut self, indent: usize) -> Result<(), NotationError> {
        while let Some(block) = self.open.pop_if(|block| block.line.indent >= indent) {
            if let Open::State(draft) = block.open {
                let state = draft.finish()?;
                self.attach(&block.line, state)?;
            }
        }
        Ok(())
    }

    /// Adds a finished state to the block around it.
    fn attach(&mut self, line: &Line<'t>, state: Arc<State>) -> Result<(), NotationError> {
        let twice = || line.error("here is place for one state only");
        let count = self.open.len();
        match self.open.last_mut().map(|block| &mut block.open) {
            None => match self.root.replace(state) {
                Some(_) => Err(twice()),
                None => Ok(()),
            },
            Some(Open::State(draft)) => draft.child(line, state),
            Some(Open::Define(name)) => match self.defined.insert(name.clone(), state) {
                Some(_) => Err(twice()),
                None => Ok(()),
            },
            Some(Open::Content) => match count.checked_sub(2).map(|at| &mut self.open[at].open) {
                Some(Open::State(draft)) => draft.content(line, state),
                _ => Err(line.error("only a library has a content")),
            },
            Some(Open::Header) => Err(line.error("the header contains no states")),
        }
    }

    fn line(&mut self, mut line: Line<'t>) -> Result<(), NotationError> {
        let begin = line;
        let word = line.peek_word();
        if KINDS.contains(&word) {
            line.eat_word(word);
            let draft = Draft::new(word, &mut line)?;
            self.open.push(Block { line: begin, open: Open::State(Box::new(draft)) });
            return Ok(());
        }
        match self.open.last_mut().map(|block| &mut block.open) {
            None => self.top_line(line),
            Some(Open::Header) => self.header_line(line),
            Some(Open::State(_)) => self.state_line(line),
            Some(Open::Content | Open::Define(_)) => Err(line.error("expected a state")),
        }
    }

    fn top_line(&mut self, mut line: Line<'t>) -> Result<(), NotationError> {
        let begin = line;
        let open = if line.eat_word("machine") {
            Open::Header
        } else if line.eat_word("define") {
            Open::Define(line.name()?)
        } else {
            return Err(line.error("expected `machine`, `define` or a state"));
        };
        line.end()?;
        self.open.push(Block { line: begin, open });
        Ok(())
    }

    fn header_line(&mut self, mut line: Line<'t>) -> Result<(), NotationError> {
        let header = &mut self.header;
        if line.eat_word("version") {
            header.version = Some(line.name()?);
        } else if line.eat_word("created") {
            header.creation_time = line.name()?;
        } else if line.eat_word("writer") {
            header.used_rafcon_version = Some(line.name()?);
        } else if line.eat_word("layout") {
            header.layout = read_layout(&mut line)?;
        } else {
            header.extra = line.extra()?;
        }
        line.end()
    }

    fn state_line(&mut self, mut line: Line<'t>) -> Result<(), NotationError> {
        let begin = line;
        match line.peek_word() {
            "content" => {
                line.eat_word("content");
                return self.content(begin, line);
            }
            word @ ("script" | "description") => {
                line.eat_word(word);
                let text = self.text(&mut line)?;
                return self.draft(&begin)?.text(&begin, word, &text);
            }
            _ => {}
        }
        let draft = self.draft(&begin)?;
        if !draft.line(&mut line)? {
            draft.transitions(&mut line)?;
        }
        Ok(())
    }

    fn draft(&mut self, line: &Line<'t>) -> Result<&mut Draft<'t>, NotationError> {
        match self.open.last_mut().map(|block| &mut block.open) {
            Some(Open::State(draft)) => Ok(draft),
            _ => Err(line.error("expected a state")),
        }
    }

    /// Parses `content` with a state below it, or `content NAME` of an earlier definition.
    fn content(&mut self, begin: Line<'t>, mut line: Line<'t>) -> Result<(), NotationError> {
        if line.at_end() {
            self.open.push(Block { line: begin, open: Open::Content });
            return Ok(());
        }
        let name = line.name()?;
        let Some(root) = self.defined.get(&name).map(Arc::clone) else {
            return Err(begin.error(format!("nothing is defined as `{name}` before this line")));
        };
        line.end()?;
        self.draft(&begin)?.content(&begin, root)
    }

    /// Parses a text in quotes, or `|` (`|-`: without a newline at its end) and a block.
    fn text(&mut self, line: &mut Line<'t>) -> Result<String, NotationError> {
        if let Some(text) = line.quoted()? {
            return line.end().map(|()| text);
        }
        line.expect("|")?;
        let newline = if line.eat_joined("-") { "" } else { "\n" };
        line.end()?;
        Ok(self.lines.block(line.indent) + newline)
    }
}
