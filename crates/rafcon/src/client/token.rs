//! The user's token and its source. Its text is never shown.

use super::Fault;
use rafcon_server::AddressFile;
use std::fmt;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Source of a token.
#[derive(Clone)]
pub(crate) enum Token {
    /// Requests are sent without a token.
    None,
    Given(String),
    /// Token of this computer's own server, valid while that server runs.
    Own {
        /// Folder of the server's state, which contains the token.
        state: PathBuf,
        /// Address of the server.
        url: String,
    },
    /// A file, read again for each connection: a restarted server may have a new token.
    File(PathBuf),
}

impl Token {
    /// The token of the server with this folder and this address.
    pub(super) fn own(state: &Path, url: &str) -> Self {
        Self::Own { state: state.to_owned(), url: url.to_owned() }
    }

    /// The text to send.
    pub(super) fn text(&self) -> Result<Option<String>, Fault> {
        match self {
            Self::None => Ok(None),
            Self::Given(text) => Ok(Some(text.clone())),
            Self::File(file) => read(file),
            Self::Own { state, url } => {
                let card = AddressFile::of_living(state).ok().flatten();
                if card.is_some_and(|card| card.url == *url) {
                    return read(&state.join("token"));
                }
                let source = io::Error::other(
                    "this server has ended, and another program may listen there now",
                );
                Err(Fault::Unreachable { server: url.clone(), source })
            }
        }
    }
}

fn read(file: &Path) -> Result<Option<String>, Fault> {
    match fs::read_to_string(file) {
        Ok(text) => Ok(Some(text.trim().to_owned())),
        Err(source) => Err(Fault::NoToken { file: file.to_owned(), source }),
    }
}

impl fmt::Debug for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => f.write_str("None"),
            Self::Given(_) => f.write_str("Given"),
            Self::Own { state, url } => write!(f, "Own({url} of {})", state.display()),
            Self::File(file) => write!(f, "File({})", file.display()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Token;

    #[test]
    fn its_text_is_never_shown() {
        assert_eq!(format!("{:?}", Token::Given("secret".to_owned())), "Given");
    }

    #[test]
    fn a_server_that_died_is_sent_no_token_of_its_owner() {
        let place = tempfile::tempdir().unwrap();
        let url = "http://127.0.0.1:1";
        let write = |name: &str, text: &str| std::fs::write(place.path().join(name), text).unwrap();
        write("token", "secret");
        write("server.json", &format!(r#"{{"url": "{url}", "pid": 1}}"#));
        write("server.lock", "");
        let (token, other) =
            (Token::own(place.path(), url), Token::own(place.path(), "http://[::1]:1"));
        assert!(token.text().is_err());
        let lock = std::fs::File::open(place.path().join("server.lock")).unwrap();
        lock.lock().unwrap();
        assert_eq!(token.text().unwrap().as_deref(), Some("secret"));
        assert!(other.text().is_err());
    }

    #[test]
    fn a_file_is_read_each_time() {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("token");
        let token = Token::File(file.clone());
        assert!(token.text().is_err());
        for text in ["one\n", "two"] {
            std::fs::write(&file, text).unwrap();
            assert_eq!(token.text().unwrap().as_deref(), Some(text.trim()));
        }
    }
}
