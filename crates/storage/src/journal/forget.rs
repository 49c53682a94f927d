//! Removes values that nobody names any more, and what only they used. Knows the tables of values; must never know why a value
//! goes.

use super::record::{Content, Stored};
use rusqlite::{OptionalExtension as _, Result, Statement, Transaction};

/// Removes values one after the other.
#[derive(Debug)]
pub(super) struct Forgetting<'t> {
    value: Statement<'t>,
    use_less: Statement<'t>,
    unused: Statement<'t>,
    file_use_less: Statement<'t>,
    file_unused: Statement<'t>,
    /// Files that nobody has any more: to be removed once this is safe.
    pub(super) files: Vec<String>,
}

impl<'t> Forgetting<'t> {
    pub(super) fn new(transaction: &'t Transaction<'_>) -> Result<Self> {
        let prepare = |text: &str| transaction.prepare(text);
        Ok(Self {
            value: prepare("DELETE FROM vals WHERE number = ?1 RETURNING hash, data")?,
            use_less: prepare("UPDATE blobs SET uses = uses - 1 WHERE hash = ?1 RETURNING data")?,
            unused: prepare("DELETE FROM blobs WHERE hash = ?1 AND uses < 1")?,
            file_use_less: prepare("UPDATE large SET uses = uses - 1 WHERE name = ?1")?,
            file_unused: prepare("DELETE FROM large WHERE name = ?1 AND uses < 1")?,
            files: Vec::new(),
        })
    }

    /// Removes the value with this number.
    pub(super) fn value(&mut self, number: i64) -> Result<()> {
        let row = |row: &rusqlite::Row<'_>| Ok((row.get(0)?, row.get(1)?));
        let value = self.value.query_row([number], row).optional()?;
        let (hash, mut data): (Option<Vec<u8>>, Option<Vec<u8>>) = value.unwrap_or_default();
        if let Some(hash) = hash {
            data = self.use_less.query_row([&hash], |row| row.get(0)).optional()?;
            self.unused.execute([&hash])?;
        }
        match data.as_deref().map(Stored::from_bytes) {
            Some(Ok(Stored { content: Content::File { hash, .. }, .. })) => self.file(hash),
            _ => Ok(()),
        }
    }

    fn file(&mut self, name: String) -> Result<()> {
        self.file_use_less.execute([&name])?;
        if self.file_unused.execute([&name])? > 0 {
            self.files.push(name);
        }
        Ok(())
    }
}
