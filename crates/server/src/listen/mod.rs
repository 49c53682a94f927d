//! The server as a process: its folder, its socket, its beginning and its end. Knows addresses and connections; does
//! not know what requests mean.

use crate::access::notice;
use crate::access::private::{self, PrivateError};
use crate::state::ServerStateError;
use crate::{ServerState, Settings, router};
use axum::Router;
use connection::Connections;
use notify::RecommendedWatcher;
use rafcon_supervisor::descriptors;
use std::fs::{File, TryLockError};
use std::future::Future;
use std::io;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;
use tls::Identity;
use tokio::net::TcpListener;
use tokio::signal::unix::{SignalKind, signal};
use tokio::sync::watch;

mod address_file;
mod connection;
mod names;
mod paced;
mod tls;

pub use address_file::AddressFile;
pub use tls::{TlsError, tls_config};

/// How long requests that are being answered hold the end of the server back.
const SHUTDOWN_GRACE: Duration = Duration::from_secs(3);

/// How long a server waits when it cannot accept a connection (no file handle is free, say).
const ACCEPT_BACKOFF: Duration = Duration::from_millis(100);

/// A server that listens.
#[derive(Debug)]
pub struct Server {
    state: Arc<ServerState>,
    listener: TcpListener,
    address: SocketAddr,
    card: AddressFile,
    identity: Option<Identity>,
    /// Sees what other programs change about users.
    _notice: Option<RecommendedWatcher>,
    /// The folder is this server's as long as this is open.
    _lock: File,
}

/// Why there is no server.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// One of its files cannot be read or written.
    #[error(transparent)]
    Private(#[from] PrivateError),
    /// One of its parts cannot begin.
    #[error(transparent)]
    ServerState(#[from] ServerStateError),
    /// Another server has the folder.
    #[error("another server uses {}: name another folder with --state, or end it first", folder.display())]
    Taken {
        /// Which folder.
        folder: PathBuf,
    },
    /// The port is taken.
    #[error(
        "something else listens on {address} already: choose another port with --bind, such as --bind 127.0.0.1:0 for one that is free"
    )]
    Busy {
        /// Which one.
        address: SocketAddr,
    },
    /// It cannot listen there.
    #[error("cannot listen on {address}: name an address of this computer with --bind")]
    Listen {
        /// Where.
        address: SocketAddr,
        /// Why not.
        source: io::Error,
    },
    /// No one could log in.
    #[error(
        "other computers reach {address}, and nobody could log in: add a user first, with `rafcon user add NAME --role admin`"
    )]
    Nobody {
        /// Where it was to listen.
        address: SocketAddr,
    },
    /// There is no certificate.
    #[error(transparent)]
    Tls(#[from] TlsError),
    /// The system gives no threads or signals.
    #[error("cannot begin to serve")]
    Begin(#[source] io::Error),
}

/// Serves until this process is asked to end (SIGINT, SIGTERM). Runs continue.
pub fn serve(settings: Settings, ready: impl FnOnce(&Server)) -> Result<(), ServeError> {
    if let Err(error) = descriptors::raise() {
        (settings.tell)(&format!("the limit of open files stays as it is: {error}"));
    }
    let mut builder = tokio::runtime::Builder::new_multi_thread();
    let runtime = builder.enable_all().thread_name("server").build().map_err(ServeError::Begin)?;
    let served = runtime.block_on(async {
        let server = Server::bind(settings).await?;
        let asked = end_signals().map_err(ServeError::Begin)?;
        ready(&server);
        server.run(asked).await
    });
    runtime.shutdown_timeout(SHUTDOWN_GRACE);
    served
}

impl Server {
    /// Prepares everything and listens; no one is answered yet.
    pub async fn bind(settings: Settings) -> Result<Self, ServeError> {
        private::folder(&settings.state)?;
        let lock = only_one(&settings.state).await?;
        let server = ServerState::new(settings)?;
        let wanted = server.settings().listen.address;
        if !wanted.ip().is_loopback() && server.people().users().roster().users().is_empty() {
            return Err(ServeError::Nobody { address: wanted });
        }
        let listener = listen(wanted).await?;
        let address = listener.local_addr().map_err(|source| cannot(wanted, source))?;
        server.called(names::of(&server.settings().listen, address));
        let identity = identity(&server, address)?;
        let fingerprint = identity.as_ref().map(|identity| identity.fingerprint.clone());
        let card = AddressFile::write(&server, address, fingerprint)?;
        server.begin();
        let notice = notice(&server);
        Ok(Self { state: server, listener, address, card, identity, _notice: notice, _lock: lock })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// What a browser or program on this computer calls it: scheme, name and port.
    pub fn url(&self) -> &str {
        &self.card.url
    }

    /// The address that lets its owner in.
    pub fn link(&self) -> String {
        format!("{}/?token={}", self.card.url, self.state.people().owner().text())
    }

    /// The token by which the bridge to ROS 2 is let in, from this computer only. It is for the child process that carries it.
    pub fn ros_token(&self) -> &str {
        self.state.people().ros().text()
    }

    /// SHA-256 of its certificate, in hexadecimal; none without TLS.
    pub fn fingerprint(&self) -> Option<&str> {
        self.card.fingerprint.as_deref()
    }

    /// What it looks after.
    pub fn state(&self) -> &Arc<ServerState> {
        &self.state
    }

    /// Answers requests until `stop`; then what is being answered is, and the card goes away.
    pub async fn run(self, stop: impl Future<Output = ()>) -> Result<(), ServeError> {
        let (closing, closed) = watch::channel(false);
        let tls = self.identity.map(|identity| identity.acceptor);
        let connections = Connections::new(&self.state.settings().listen, tls, closed);
        let router = router(Arc::clone(&self.state));
        tokio::select! {
            () = accept(&self.listener, &connections, &router) => {}
            () = connections.report(self.state.settings().tell) => {}
            () = stop => {}
        }
        drop(self.listener);
        self.state.close();
        closing.send_replace(true);
        connections.gone(SHUTDOWN_GRACE).await;
        self.state.audit().settle();
        Ok(self.card.remove()?)
    }
}

/// Takes connections for ever.
#[expect(clippy::infinite_loop, reason = "it ends by being dropped, as futures do")]
async fn accept(listener: &TcpListener, connections: &Connections, router: &Router) {
    loop {
        connections.room().await;
        match listener.accept().await {
            Ok((stream, peer)) => connections.begin(stream, peer, router.clone()),
            // The client has hung up already, or no descriptor is free.
            Err(_) => tokio::time::sleep(ACCEPT_BACKOFF).await,
        }
    }
}

fn identity(server: &ServerState, address: SocketAddr) -> Result<Option<Identity>, TlsError> {
    let is_needed = server.names().is_secure;
    is_needed.then(|| tls::identity(server.settings(), address)).transpose()
}

async fn listen(address: SocketAddr) -> Result<TcpListener, ServeError> {
    TcpListener::bind(address).await.map_err(|source| cannot(address, source))
}

fn cannot(address: SocketAddr, source: io::Error) -> ServeError {
    match source.kind() {
        io::ErrorKind::AddrInUse => ServeError::Busy { address },
        _other => ServeError::Listen { address, source },
    }
}

/// A program that a server was just starting when it was killed holds its lock until that program runs: so often it is asked
/// for, with a pause.
const TRIES: u32 = 100;
const PAUSE: Duration = Duration::from_millis(20);

/// Makes this process the folder's only server.
async fn only_one(folder: &Path) -> Result<File, ServeError> {
    let path = folder.join(address_file::LOCK);
    let file = private::open(&path)?;
    for _ in 0..TRIES {
        match file.try_lock() {
            Ok(()) => return Ok(file),
            Err(TryLockError::WouldBlock) => tokio::time::sleep(PAUSE).await,
            Err(TryLockError::Error(source)) => {
                return Err(PrivateError::new("lock", &path, source).into());
            }
        }
    }
    Err(ServeError::Taken { folder: folder.to_owned() })
}

/// Ready once one has come. Signals count from this call on.
fn end_signals() -> io::Result<impl Future<Output = ()>> {
    let mut interrupt = signal(SignalKind::interrupt())?;
    let mut terminate = signal(SignalKind::terminate())?;
    Ok(async move {
        tokio::select! {
            _ = interrupt.recv() => {}
            _ = terminate.recv() => {}
        }
    })
}
