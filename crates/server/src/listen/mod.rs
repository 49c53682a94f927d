//! The server as a process: its folder, its socket, its start and its shutdown. Knows addresses and connections; does not know
//! the meaning of requests.

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

/// Time limit for pending requests at shutdown.
const SHUTDOWN_GRACE: Duration = Duration::from_secs(3);

/// Pause after a failed accept, for example if no file descriptor is free.
const ACCEPT_BACKOFF: Duration = Duration::from_millis(100);

/// A server that listens.
#[derive(Debug)]
pub struct Server {
    state: Arc<ServerState>,
    listener: TcpListener,
    address: SocketAddr,
    card: AddressFile,
    identity: Option<Identity>,
    /// Watches the changes that other programs make to users.
    _notice: Option<RecommendedWatcher>,
    /// Exclusive lock on the server's folder.
    _lock: File,
}

/// The server cannot start.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// One of its files cannot be read or written.
    #[error(transparent)]
    Private(#[from] PrivateError),
    /// One of its parts cannot start.
    #[error(transparent)]
    ServerState(#[from] ServerStateError),
    /// Another server holds the lock of the folder.
    #[error("another server uses {}: name another folder with --state, or end it first", folder.display())]
    Taken {
        /// The folder that is in use.
        folder: PathBuf,
    },
    /// The port is in use.
    #[error(
        "something else listens on {address} already: choose another port with --bind, such as --bind 127.0.0.1:0 for one that is free"
    )]
    Busy {
        /// The address that is in use.
        address: SocketAddr,
    },
    /// The server cannot listen at this address.
    #[error("cannot listen on {address}: name an address of this computer with --bind")]
    Listen {
        /// The address that failed.
        address: SocketAddr,
        /// The error of the system call.
        source: io::Error,
    },
    /// Other computers can reach the server, but it has no user who can log in.
    #[error(
        "other computers reach {address}, and nobody could log in: add a user first, with `rafcon user add NAME --role admin`"
    )]
    Nobody {
        /// The address in the settings.
        address: SocketAddr,
    },
    /// The server has no usable certificate.
    #[error(transparent)]
    Tls(#[from] TlsError),
    /// The system does not provide threads or signals.
    #[error("cannot begin to serve")]
    Begin(#[source] io::Error),
}

/// Serves until this process receives SIGINT or SIGTERM. Runs continue.
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
    /// Prepares all parts and listens. Requests are served only by [`Self::run`].
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

    /// The address that the server listens on.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Its URL for programs on this computer: scheme, name and port.
    pub fn url(&self) -> &str {
        &self.card.url
    }

    /// The URL with the owner's token, which logs its owner in.
    pub fn link(&self) -> String {
        format!("{}/?token={}", self.card.url, self.state.people().owner().text())
    }

    /// The token of the bridge to ROS 2, valid on this computer only. Pass it to the child process.
    pub fn ros_token(&self) -> &str {
        self.state.people().ros().text()
    }

    /// SHA-256 of its certificate, in hexadecimal. `None` without TLS.
    pub fn fingerprint(&self) -> Option<&str> {
        self.card.fingerprint.as_deref()
    }

    /// The shared state of the server.
    pub fn state(&self) -> &Arc<ServerState> {
        &self.state
    }

    /// Serves requests until `stop`. Then finishes pending requests and removes the address file.
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

/// Accepts connections until dropped.
#[expect(clippy::infinite_loop, reason = "it ends by being dropped, as futures do")]
async fn accept(listener: &TcpListener, connections: &Connections, router: &Router) {
    loop {
        connections.room().await;
        match listener.accept().await {
            Ok((stream, peer)) => connections.begin(stream, peer, router.clone()),
            // The client has already disconnected, or no descriptor is free.
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

/// Number of attempts, with a pause between them, to get the lock. A program that a killed server was just starting may hold the
/// lock for a moment.
const TRIES: u32 = 100;
const PAUSE: Duration = Duration::from_millis(20);

/// Takes the lock that makes this process the only server of the folder.
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

/// Completes at the first signal. Signals are caught from this call on.
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
