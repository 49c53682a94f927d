//! Credentials of this user for servers: certificates and tokens, in files that only the user can read.

use super::{Address, Fingerprint};
use anyhow::{Context as _, Result};
use std::collections::BTreeMap;
use std::fs::{self, DirBuilder};
use std::io::{self, Write as _};
use std::os::unix::fs::DirBuilderExt as _;
use std::path::{Path, PathBuf};

const KNOWN: &str = "known_servers";
const TOKENS: &str = "tokens.json";

/// The folder with both files.
#[derive(Debug, Clone)]
pub(crate) struct CredentialStore {
    folder: PathBuf,
}

impl CredentialStore {
    /// A store in this folder, which may not exist yet.
    pub(crate) fn new(folder: PathBuf) -> Self {
        Self { folder }
    }

    /// The saved certificate of a server, from the first connection.
    pub(crate) fn certificate(&self, address: &Address) -> Result<Option<Fingerprint>> {
        let text = self.read(KNOWN)?;
        Ok(found(&text, &address.authority()))
    }

    /// Saves a server's certificate, and replaces an earlier one.
    pub(crate) fn remember(&self, address: &Address, print: &Fingerprint) -> Result<()> {
        let text = self.read(KNOWN)?;
        self.write(KNOWN, &with(&text, &address.authority(), print))
    }

    /// The token from a login.
    pub(crate) fn token(&self, address: &Address) -> Result<Option<String>> {
        Ok(self.tokens()?.remove(&address.to_string()))
    }

    /// Saves a token, and replaces an earlier one.
    pub(crate) fn keep_token(&self, address: &Address, token: &str) -> Result<()> {
        let mut tokens = self.tokens()?;
        tokens.insert(address.to_string(), token.to_owned());
        self.write(TOKENS, &serde_json::to_string_pretty(&tokens)?)
    }

    fn tokens(&self) -> Result<BTreeMap<String, String>> {
        let text = self.read(TOKENS)?;
        if text.is_empty() {
            return Ok(BTreeMap::new());
        }
        // Drop the parser's error: it could contain a token.
        serde_json::from_str(&text).ok().with_context(|| {
            let file = self.folder.join(TOKENS);
            format!("{} is damaged: delete it, and log in again", file.display())
        })
    }

    fn read(&self, name: &str) -> Result<String> {
        let file = self.folder.join(name);
        match fs::read_to_string(&file) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(String::new()),
            text => text.with_context(|| format!("cannot read {}", file.display())),
        }
    }

    fn write(&self, name: &str, text: &str) -> Result<()> {
        let file = self.folder.join(name);
        replace(&self.folder, &file, text)
            .with_context(|| format!("cannot write {}", file.display()))
    }
}

/// Replaces a file by renaming a temporary one, which only its owner can read.
fn replace(folder: &Path, file: &Path, text: &str) -> io::Result<()> {
    DirBuilder::new().recursive(true).mode(0o700).create(folder)?;
    let mut staged = tempfile::NamedTempFile::new_in(folder)?;
    staged.write_all(text.as_bytes())?;
    staged.as_file().sync_all()?;
    staged.persist(file)?;
    Ok(())
}

/// Finds the fingerprint of a server in lines of address and fingerprint.
fn found(text: &str, server: &str) -> Option<Fingerprint> {
    let of =
        |line: &str| line.split_once(' ').map(|(name, print)| (name.to_owned(), print.to_owned()));
    let line = text.lines().filter_map(of).find(|(name, _)| name == server);
    line.and_then(|(_, print)| Fingerprint::parse(&print))
}

fn with(text: &str, server: &str, print: &Fingerprint) -> String {
    let others = text.lines().filter(|line| line.split(' ').next() != Some(server));
    let mut lines: Vec<String> = others.map(str::to_owned).collect();
    lines.push(format!("{server} sha256:{}", print.hex()));
    lines.join("\n") + "\n"
}

#[cfg(test)]
mod tests {
    use super::{Address, CredentialStore, Fingerprint};
    use std::os::unix::fs::PermissionsExt as _;

    #[test]
    fn what_is_written_is_read_and_nobody_else_may() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("config/rafcon");
        let notebook = CredentialStore::new(folder.clone());
        let address = |text| Address::parse(text).unwrap().0;
        let (rover, other) = (address("https://rover"), address("https://other:1"));
        let (first, second) = (Fingerprint::of(b"1"), Fingerprint::of(b"2"));
        assert_eq!(notebook.certificate(&rover).unwrap(), None);
        for (server, print) in [(&rover, first), (&other, first), (&rover, second)] {
            notebook.remember(server, &print).unwrap();
        }
        assert_eq!(notebook.certificate(&rover).unwrap(), Some(second));
        assert_eq!(notebook.certificate(&other).unwrap(), Some(first));
        assert_eq!(notebook.token(&rover).unwrap(), None);
        notebook.keep_token(&rover, "secret").unwrap();
        assert_eq!(notebook.token(&rover).unwrap().as_deref(), Some("secret"));
        let mode = |name: &str| folder.join(name).metadata().unwrap().permissions().mode() & 0o777;
        assert_eq!((mode(""), mode("known_servers"), mode("tokens.json")), (0o700, 0o600, 0o600));
    }

    #[test]
    fn damaged_tokens_are_not_repeated() {
        let place = tempfile::tempdir().unwrap();
        std::fs::write(place.path().join("tokens.json"), "secret").unwrap();
        let notebook = CredentialStore::new(place.path().to_path_buf());
        let rover = Address::parse("https://rover").unwrap().0;
        let error = format!("{:#}", notebook.token(&rover).unwrap_err());
        assert!(error.contains("is damaged") && !error.contains("secret"), "{error}");
    }
}
