//! TLS identity of the server. The certificate is made on first use and stored, so that a fingerprint needs to be verified only once.

use super::names;
use crate::access::hex;
use crate::access::private::{self, PrivateError};
use crate::settings::{Listen, Settings};
use ring::digest::{SHA256, digest};
use std::fmt;
use std::net::{IpAddr, SocketAddr};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tokio_rustls::TlsAcceptor;
use tokio_rustls::rustls::crypto::ring::default_provider;
use tokio_rustls::rustls::pki_types::pem::{Error as PemError, PemObject as _};
use tokio_rustls::rustls::pki_types::{CertificateDer, PrivateKeyDer};
use tokio_rustls::rustls::{Error as RustlsError, ServerConfig};

/// Certificate and key of the server, ready for use.
pub(super) struct Identity {
    pub(super) acceptor: TlsAcceptor,
    /// SHA-256 of the certificate, in hexadecimal.
    pub(super) fingerprint: String,
}

impl fmt::Debug for Identity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Identity").field(&self.fingerprint).finish()
    }
}

/// TLS is not available.
#[derive(Debug, thiserror::Error)]
pub enum TlsError {
    /// The server's own files cannot be written.
    #[error(transparent)]
    Private(#[from] PrivateError),
    /// A file contains no valid certificate or key.
    #[error("cannot read {} as PEM: name a certificate with --certificate and its key with --key", path.display())]
    Pem {
        /// The file that cannot be parsed.
        path: PathBuf,
        /// The error of the parser.
        source: PemError,
    },
    /// The file contains no certificate.
    #[error("there is no certificate in {}: name a file that holds one with --certificate", path.display())]
    Empty {
        /// The file without a certificate.
        path: PathBuf,
    },
    /// Certificate and key cannot be used together.
    #[error("the certificate {} cannot be used with its key: name another pair", path.display())]
    Pair {
        /// The file of the certificate.
        path: PathBuf,
        /// The error of the TLS library.
        source: RustlsError,
    },
    /// A new certificate cannot be made.
    #[error("cannot make a certificate: name one with --certificate and --key")]
    Make(#[source] rcgen::Error),
}

/// True if the server uses TLS: always at addresses that other computers can reach, and with a configured certificate.
pub(super) fn is_needed(listen: &Listen, address: SocketAddr) -> bool {
    !address.ip().is_loopback() || listen.certificate.is_some()
}

/// TLS configuration and certificate fingerprint of a server with these settings, for other listeners. Makes the certificate if
/// it does not exist.
pub fn tls_config(settings: &Settings) -> Result<(Arc<ServerConfig>, String), TlsError> {
    private::folder(&settings.state)?;
    let Identity { acceptor, fingerprint } = identity(settings, settings.listen.address)?;
    Ok((Arc::clone(acceptor.config()), fingerprint))
}

/// The identity of the server. Makes a certificate if none is configured or stored.
pub(super) fn identity(settings: &Settings, address: SocketAddr) -> Result<Identity, TlsError> {
    let named = settings.listen.certificate.clone();
    let (certificate, key) = match named {
        Some(pair) => pair,
        None => own(&settings.state, &settings.listen, address)?,
    };
    let chain = chain(&certificate)?;
    let pem = |path: &Path, source| TlsError::Pem { path: path.to_owned(), source };
    let secret = PrivateKeyDer::from_pem_file(&key).map_err(|source| pem(&key, source))?;
    let fingerprint = chain.first().map(|first| fingerprint(first));
    let fingerprint = fingerprint.ok_or_else(|| TlsError::Empty { path: certificate.clone() })?;
    let config = config(chain, secret);
    let config = config.map_err(|source| TlsError::Pair { path: certificate, source })?;
    Ok(Identity { acceptor: TlsAcceptor::from(Arc::new(config)), fingerprint })
}

fn config(
    chain: Vec<CertificateDer<'static>>,
    key: PrivateKeyDer<'static>,
) -> Result<ServerConfig, RustlsError> {
    let builder = ServerConfig::builder_with_provider(Arc::new(default_provider()));
    let builder = builder.with_safe_default_protocol_versions()?.with_no_client_auth();
    let mut config = builder.with_single_cert(chain, key)?;
    config.alpn_protocols = vec![b"http/1.1".to_vec()];
    Ok(config)
}

fn chain(path: &Path) -> Result<Vec<CertificateDer<'static>>, TlsError> {
    let read = CertificateDer::pem_file_iter(path);
    let read = read.and_then(Iterator::collect::<Result<Vec<_>, _>>);
    read.map_err(|source| TlsError::Pem { path: path.to_owned(), source })
}

fn fingerprint(certificate: &CertificateDer<'_>) -> String {
    hex(digest(&SHA256, certificate).as_ref())
}

/// The pair in the server's folder, which is made if it does not exist.
fn own(state: &Path, listen: &Listen, address: SocketAddr) -> Result<(PathBuf, PathBuf), TlsError> {
    let (certificate, key) = (state.join("certificate.pem"), state.join("key.pem"));
    if !certificate.exists() || !key.exists() {
        let made = rcgen::generate_simple_self_signed(names_of(listen, address));
        let made = made.map_err(TlsError::Make)?;
        private::write(&key, made.signing_key.serialize_pem().as_bytes())?;
        private::write(&certificate, made.cert.pem().as_bytes())?;
    }
    Ok((certificate, key))
}

/// Names and addresses in a new certificate.
fn names_of(listen: &Listen, address: SocketAddr) -> Vec<String> {
    let names = names::of(listen, address);
    let mut names = [names.given, names.hosts].concat();
    names.extend(["127.0.0.1".to_owned(), "::1".to_owned()]);
    let ip: IpAddr = address.ip();
    if !ip.is_unspecified() && !ip.is_loopback() {
        names.push(ip.to_string());
    }
    names
}

#[cfg(test)]
mod tests {
    use super::{identity, names_of};
    use crate::settings::Settings;
    use std::fs;

    #[test]
    fn a_certificate_is_made_once_and_is_good_for_the_names_of_the_server() {
        let place = tempfile::tempdir().unwrap();
        let mut settings = Settings::new(place.path().to_owned(), place.path().join("runs"));
        settings.listen.hosts = vec!["Rover.lan".to_owned()];
        let address = "192.168.0.7:4747".parse().unwrap();
        let first = identity(&settings, address).unwrap().fingerprint;
        assert_eq!(identity(&settings, address).unwrap().fingerprint, first);
        let names = names_of(&settings.listen, address);
        for name in ["rover.lan", "localhost", "127.0.0.1", "::1", "192.168.0.7"] {
            assert!(names.iter().any(|other| other == name), "{name}: {names:?}");
        }
        fs::remove_file(place.path().join("key.pem")).unwrap();
        assert_ne!(identity(&settings, address).unwrap().fingerprint, first);
    }

    #[test]
    fn a_file_without_a_certificate_is_named() {
        let place = tempfile::tempdir().unwrap();
        let mut settings = Settings::new(place.path().to_owned(), place.path().join("runs"));
        let file = place.path().join("empty.pem");
        fs::write(&file, "").unwrap();
        settings.listen.certificate = Some((file.clone(), file.clone()));
        let error = identity(&settings, settings.listen.address).unwrap_err();
        assert!(error.to_string().contains(&file.display().to_string()), "{error}");
    }
}
