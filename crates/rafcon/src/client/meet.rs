//! Connection setup with a server: trust in its certificate, and the token for it.

use super::{Address, CredentialStore, FRAME_TIMEOUT, Fault, Fingerprint, Server, Stream, Token};
use crate::failure::{Usage, complain};
use anyhow::Result;
use rafcon_server::AddressFile;
use std::io::{self, IsTerminal as _, Write as _};
use std::path::Path;

/// Inputs for the decision to trust a server.
#[derive(Debug)]
pub(crate) struct TrustDecision<'a> {
    /// The address from the user.
    pub(crate) url: &'a str,
    /// A file with the token.
    pub(crate) token_file: Option<&'a Path>,
    /// The token of the environment.
    pub(crate) token: Option<&'a str>,
    /// The certificate that the user vouches for.
    pub(crate) fingerprint: Option<&'a str>,
    /// The saved certificates and tokens.
    pub(crate) notebook: &'a CredentialStore,
    /// The folder of this computer's own server.
    pub(crate) state: Option<&'a Path>,
}

impl TrustDecision<'_> {
    /// Connects to the server if its certificate is trusted.
    pub(crate) fn meet(&self) -> Result<Server> {
        let (address, token) = Address::parse(self.url).map_err(Usage)?;
        if !address.is_secure && !address.is_loopback() {
            let why = "without TLS, others in the network could read the token; write https://";
            return Err(Usage(format!("--server {address}: {why}")).into());
        }
        let own = self.own(&address);
        let trusted =
            if address.is_secure { Some(self.trusted(&address, own.as_ref())?) } else { None };
        let token = self.token(&address, token, own.as_ref())?;
        Ok(Server::new(address, trusted, token))
    }

    /// The address file of this computer's server, if it runs and has this address: at any other address of this computer,
    /// another user's program may listen.
    fn own(&self, address: &Address) -> Option<AddressFile> {
        let card = AddressFile::of_living(self.state?).ok()??;
        let (own, _) = Address::parse(&card.url).ok()?;
        (own.origin() == address.origin() && address.is_loopback()).then_some(card)
    }

    fn token(
        &self,
        address: &Address,
        in_url: Option<String>,
        own: Option<&AddressFile>,
    ) -> Result<Token> {
        if let Some(token) = in_url {
            return Ok(Token::Given(token));
        }
        if let Some(file) = self.token_file {
            return Ok(Token::File(file.to_path_buf()));
        }
        if let Some(token) = self.token {
            return Ok(Token::Given(token.to_owned()));
        }
        if let Some(token) = self.notebook.token(address)? {
            return Ok(Token::Given(token));
        }
        Ok(match (own, self.state) {
            (Some(card), Some(state)) => Token::own(state, &card.url),
            _ => Token::None,
        })
    }

    /// The certificate that the server must have. A fingerprint from the user replaces the saved one.
    fn trusted(&self, address: &Address, own: Option<&AddressFile>) -> Result<Fingerprint> {
        if let Some(text) = self.fingerprint {
            let print = Fingerprint::parse(text).ok_or_else(|| {
                Usage(format!("--fingerprint {text}: write 64 hexadecimal digits"))
            })?;
            check(address, Some(print))?;
            self.remember(address, &print);
            return Ok(print);
        }
        if let Some(print) = self.notebook.certificate(address)? {
            return Ok(print);
        }
        if let Some(print) = own.and_then(|card| Fingerprint::parse(card.fingerprint.as_deref()?)) {
            return Ok(print);
        }
        match check(address, None) {
            Err(Fault::Unknown { seen, .. }) if may_ask() && vouched(address, &seen)? => {
                self.remember(address, &seen);
                Ok(seen)
            }
            Err(fault) => Err(fault.into()),
            // No connection is made without a trusted certificate.
            Ok(()) => {
                Err(Usage(format!("--server {address}: the server shows no certificate")).into())
            }
        }
    }

    /// Saves the certificate. A failure, such as a full disk, does not block access to the robot.
    fn remember(&self, address: &Address, print: &Fingerprint) {
        if let Err(error) = self.notebook.remember(address, print) {
            complain(&format!("warning: {error:#}: this certificate is accepted now only"));
        }
    }
}

/// Checks that the server has this certificate.
fn check(address: &Address, trusted: Option<Fingerprint>) -> Result<(), Fault> {
    Stream::connect(address, trusted, FRAME_TIMEOUT).map(drop)
}

/// True if a person can be asked.
fn may_ask() -> bool {
    io::stdin().is_terminal() && io::stderr().is_terminal()
}

fn vouched(address: &Address, seen: &Fingerprint) -> io::Result<bool> {
    let question = format!(
        "This computer does not know the server at {address} yet. Its certificate has the fingerprint\n  {seen}\n\
         Is it the one that `rafcon serve` printed there? `yes` saves it. [yes/no] "
    );
    io::stderr().write_all(question.as_bytes())?;
    let mut answer = String::new();
    io::stdin().read_line(&mut answer)?;
    Ok(answer.trim().eq_ignore_ascii_case("yes"))
}
