//! The token that says who asks, and where it is from. Its text is never shown.

use super::Fault;
use std::fmt;
use std::fs;
use std::path::PathBuf;

/// Where a token is from.
#[derive(Clone)]
pub(crate) enum Token {
    /// There is none.
    None,
    /// This text.
    Given(String),
    /// A file, read again for each connection: a server may get another one when it is started again.
    File(PathBuf),
}

impl Token {
    /// What is sent.
    pub(super) fn text(&self) -> Result<Option<String>, Fault> {
        match self {
            Self::None => Ok(None),
            Self::Given(text) => Ok(Some(text.clone())),
            Self::File(file) => match fs::read_to_string(file) {
                Ok(text) => Ok(Some(text.trim().to_owned())),
                Err(source) => Err(Fault::NoToken { file: file.clone(), source }),
            },
        }
    }
}

impl fmt::Debug for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => f.write_str("None"),
            Self::Given(_) => f.write_str("Given"),
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
