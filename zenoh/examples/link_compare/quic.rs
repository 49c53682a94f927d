//! One stream of QUIC, with a connection that no silence ends.

use crate::Trial;
use crate::events::number;
use crate::figures::{Figures, Recorder};
use crate::proxy::Carries;
use anyhow::{Context as _, Result};
use quinn::crypto::rustls::{QuicClientConfig, QuicServerConfig};
use quinn::{ClientConfig, Connection, Endpoint, RecvStream, ServerConfig, TransportConfig};
use rustls::RootCertStore;
use rustls::crypto::ring::default_provider;
use rustls::pki_types::PrivateKeyDer;
use std::sync::Arc;
use std::time::Duration;

/// Writes each event to the stream.
pub(crate) async fn carry(trial: &Trial) -> Result<Figures> {
    let (server, client) = configs()?;
    let station = Endpoint::server(server, "127.0.0.1:0".parse()?)?;
    let proxy = trial.link(Carries::Datagrams, station.local_addr()?)?;
    let recorder = Arc::new(Recorder::new(trial.begin, &trial.events));
    let notes = Arc::clone(&recorder);
    tokio::spawn(async move { receive(&station, &notes).await });
    let mut robot = Endpoint::client("127.0.0.1:0".parse()?)?;
    robot.set_default_client_config(client);
    let connection = robot.connect(proxy.address, "localhost")?.await;
    let connection = connection.context("the station is not reached")?;
    let sends = trial.clone();
    tokio::spawn(async move { send(&sends, connection).await });
    trial.judge(proxy, &recorder).await
}

async fn send(trial: &Trial, connection: Connection) -> Result<()> {
    let mut stream = connection.open_uni().await?;
    for number in trial.numbers() {
        trial.happens(number).await;
        let bytes = trial.events.numbered(number);
        let length = u16::try_from(bytes.len()).unwrap_or(u16::MAX);
        drop(stream.write_all(&[&length.to_le_bytes()[..], &bytes].concat()).await);
    }
    // The connection ends with the last that has it.
    connection.closed().await;
    Ok(())
}

async fn receive(station: &Endpoint, recorder: &Recorder) -> Result<()> {
    let connection = station.accept().await.context("no one comes")?.await?;
    let mut stream: RecvStream = connection.accept_uni().await?;
    loop {
        let mut length = [0; 2];
        stream.read_exact(&mut length).await?;
        let mut bytes = vec![0; u16::from_le_bytes(length).into()];
        stream.read_exact(&mut bytes).await?;
        recorder.note(number(&bytes).unwrap_or(usize::MAX));
    }
}

fn configs() -> Result<(ServerConfig, ClientConfig)> {
    let made = rcgen::generate_simple_self_signed(["localhost".to_owned()])?;
    let certificate = made.cert.der().clone();
    let key = PrivateKeyDer::try_from(made.signing_key.serialize_der()).ok().context("no key")?;
    let mut roots = RootCertStore::empty();
    roots.add(certificate.clone())?;
    let provider = Arc::new(default_provider());
    let server = rustls::ServerConfig::builder_with_provider(Arc::clone(&provider))
        .with_safe_default_protocol_versions()?
        .with_no_client_auth()
        .with_single_cert(vec![certificate], key)?;
    let client = rustls::ClientConfig::builder_with_provider(provider)
        .with_safe_default_protocol_versions()?
        .with_root_certificates(roots)
        .with_no_client_auth();
    let mut transport = TransportConfig::default();
    transport.max_idle_timeout(None).keep_alive_interval(Some(Duration::from_secs(1)));
    let transport = Arc::new(transport);
    let mut server = ServerConfig::with_crypto(Arc::new(QuicServerConfig::try_from(server)?));
    server.transport_config(Arc::clone(&transport));
    let mut client = ClientConfig::new(Arc::new(QuicClientConfig::try_from(client)?));
    client.transport_config(transport);
    Ok((server, client))
}
