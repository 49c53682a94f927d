//! The server with TLS, for a client that trusts one certificate.

use crate::harness::TestServer;
use rafcon_protocol::api::Role;
use ring::digest::{SHA256, digest};
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;
use tokio_rustls::rustls::crypto::ring::default_provider;
use tokio_rustls::rustls::pki_types::pem::PemObject as _;
use tokio_rustls::rustls::pki_types::{CertificateDer, ServerName};
use tokio_rustls::rustls::{ClientConfig, ClientConnection, RootCertStore, Stream};

/// A server with a certificate for these names, and the certificate's file.
fn server(place: &Path, names: &[&str]) -> TestServer {
    let names = names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
    let made = rcgen::generate_simple_self_signed(names).unwrap();
    let (certificate, key) = (place.join("certificate.pem"), place.join("key.pem"));
    std::fs::write(&certificate, made.cert.pem()).unwrap();
    std::fs::write(&key, made.signing_key.serialize_pem()).unwrap();
    TestServer::with(|settings| settings.listen.certificate = Some((certificate, key)))
}

/// The response for a client that trusts this certificate and uses this host name.
fn ask(server: &TestServer, trusted: &Path, name: &'static str) -> Result<String, String> {
    let mut roots = RootCertStore::empty();
    roots.add(CertificateDer::from_pem_file(trusted).unwrap()).unwrap();
    let builder = ClientConfig::builder_with_provider(Arc::new(default_provider()));
    let builder = builder.with_safe_default_protocol_versions().unwrap();
    let config = Arc::new(builder.with_root_certificates(roots).with_no_client_auth());
    let name = ServerName::try_from(name).unwrap();
    let mut connection = ClientConnection::new(config, name).unwrap();
    let mut socket = TcpStream::connect(server.address()).unwrap();
    socket.set_read_timeout(Some(Duration::from_secs(15))).unwrap();
    let mut stream = Stream::new(&mut connection, &mut socket);
    let (host, token) = (server.address(), server.token(Role::Viewer));
    let request = format!(
        "GET /api/v1/session HTTP/1.1\r\nHost: {host}\r\nAuthorization: Bearer {token}\r\nConnection: close\r\n\r\n"
    );
    stream.write_all(request.as_bytes()).map_err(|error| error.to_string())?;
    let mut text = String::new();
    stream.read_to_string(&mut text).map_err(|error| error.to_string())?;
    Ok(text)
}

#[test]
fn a_client_that_trusts_the_certificate_is_answered() {
    let place = tempfile::tempdir().unwrap();
    let server = server(place.path(), &["localhost"]);
    let file = place.path().join("certificate.pem");
    let answer = ask(&server, &file, "localhost").unwrap();
    assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
    let only_tls = "strict-transport-security: max-age=2592000\r\n";
    assert!(answer.to_lowercase().contains(only_tls), "{answer}");
    assert!(server.url().starts_with("https://"), "{}", server.url());
    ask(&server, &file, "rover.lan").unwrap_err();
}

#[test]
fn the_card_tells_the_fingerprint() {
    let place = tempfile::tempdir().unwrap();
    let server = server(place.path(), &["localhost"]);
    let der = CertificateDer::from_pem_file(place.path().join("certificate.pem")).unwrap();
    let bytes = digest(&SHA256, &der);
    let digits = bytes.as_ref().iter().map(|byte| format!("{byte:02x}")).collect::<Vec<_>>();
    let expected = digits.concat();
    let card = rafcon_server::AddressFile::read(&server.state()).unwrap().unwrap();
    assert_eq!(card.fingerprint.as_deref(), Some(expected.as_str()));
    assert_eq!(
        rafcon_server::AddressFile::read(server.end().path().join("state").as_path()).unwrap(),
        None
    );
}

#[test]
fn who_speaks_no_tls_is_hung_up_on() {
    let place = tempfile::tempdir().unwrap();
    let server = server(place.path(), &["localhost"]);
    let health = ("Host", "localhost");
    let text = crate::raw::ask(&server, "GET /api/v1/health", &[health]);
    assert_eq!(crate::raw::status(&text), 0);
}
