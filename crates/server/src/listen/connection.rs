//! Connections of clients, limited in number, and each with a time limit for a request's head. Knows streams; does not know the requests.

use super::paced::Paced;
use crate::access::{BasePrefix, Capacity, ConnectionSlot, ConnectionSlots, Peer};
use crate::settings::{BasePath, Listen};
use axum::Router;
use axum::http::uri::PathAndQuery;
use axum::http::{Request, Uri};
use hyper::server::conn::http1;
use hyper::service::{Service as _, service_fn};
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use rafcon_supervisor::descriptors;
use rustix::net::sockopt::set_socket_send_buffer_size;
use std::net::SocketAddr;
use std::pin::pin;
use std::sync::Arc;
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::TcpStream;
use tokio::sync::watch;
use tokio::time::{sleep, timeout};
use tokio_rustls::TlsAcceptor;
use tower_http::add_extension::AddExtension;

/// Size of the kernel's send buffer for a client, in bytes; enough for 0.5 Mbit/s at a round trip of 4 s.
const SEND_BUFFER: usize = 256 * 1024;

/// Maximum wait until connections that lost their slot are closed.
const CLOSE_TIMEOUT: Duration = Duration::from_millis(100);

/// Minimum interval between log lines about a shortage of slots.
pub(super) const REPORT_INTERVAL: Duration = Duration::from_mins(1);

/// All connections of a server.
pub(super) struct Connections {
    places: ConnectionSlots,
    service: RequestService,
}

/// Serves the requests of one connection.
#[derive(Clone)]
struct RequestService {
    http: http1::Builder,
    tls: Option<TlsAcceptor>,
    patience: Duration,
    write_limit: Duration,
    closed: watch::Receiver<bool>,
    base: BasePath,
}

impl Connections {
    pub(super) fn new(
        listen: &Listen,
        tls: Option<TlsAcceptor>,
        closed: watch::Receiver<bool>,
    ) -> Self {
        let mut http = http1::Builder::new();
        http.timer(TokioTimer::new()).header_read_timeout(listen.head_patience);
        let places =
            ConnectionSlots::new(Capacity::of(listen.connections_max, descriptors::free()));
        let (patience, write_limit) = (listen.head_patience, listen.write_limit);
        let base = listen.base_path.clone();
        let service = RequestService { http, tls, patience, write_limit, closed, base };
        Self { places, service }
    }

    /// Serves a connection. Closes it at once if no slot is free.
    pub(super) fn begin(&self, stream: TcpStream, peer: SocketAddr, router: Router) {
        let peer = Peer::of(peer, stream.local_addr().ok());
        let Some((place, lost)) = self.places.take(peer) else { return };
        // Otherwise the second part of a response waits for the client's acknowledgement.
        stream.set_nodelay(true).unwrap_or_default();
        // Unread data occupies the kernel's memory, and the clients are many.
        set_socket_send_buffer_size(&stream, SEND_BUFFER).unwrap_or_default();
        let io = Paced::new(stream, self.service.write_limit, Arc::clone(&place), lost);
        let service = self.service.clone();
        tokio::spawn(async move { service.welcome(io, peer, place, router).await });
    }

    /// Waits, for a limited time, until connections that lost their slot are closed and a file is free.
    pub(super) async fn room(&self) {
        self.places.wait_until_closed(CLOSE_TIMEOUT).await;
    }

    /// Logs a shortage of slots, at most once per interval.
    #[expect(clippy::infinite_loop, reason = "it ends by being dropped, as futures do")]
    pub(super) async fn report(&self, log: fn(&str)) {
        let Capacity { all, anonymous } = self.places.capacity();
        let mut crowded_out = self.places.crowded_out();
        loop {
            // The sender lives as long as this function.
            drop(crowded_out.changed().await);
            let count = *crowded_out.borrow_and_update();
            log(&format!(
                "too many connections ({all} at most, {anonymous} of them without a login, a quarter from one other network): \
                 each new one ends the oldest without a login; {count} were ended or refused since the start"
            ));
            sleep(REPORT_INTERVAL).await;
        }
    }

    /// Waits, for a limited time, until all connections are closed.
    pub(super) async fn gone(&self, patience: Duration) {
        self.places.wait_until_free(patience).await;
    }
}

impl RequestService {
    /// Starts to serve a connection. With TLS, the handshake has a timeout.
    async fn welcome(
        self,
        io: Paced<TcpStream>,
        peer: Peer,
        place: Arc<ConnectionSlot>,
        router: Router,
    ) {
        let Some(tls) = &self.tls else { return self.answer(io, peer, place, router).await };
        if let Ok(Ok(io)) = timeout(self.patience, tls.accept(io)).await {
            self.answer(io, peer, place, router).await;
        }
    }

    async fn answer(
        &self,
        io: impl Stream,
        peer: Peer,
        place: Arc<ConnectionSlot>,
        router: Router,
    ) {
        let router = AddExtension::new(AddExtension::new(router, peer), place);
        let service = TowerToHyperService::new(router);
        let base = self.base.clone();
        let service = service_fn(move |request| service.call(without_base(request, &base)));
        let connection = self.http.serve_connection(TokioIo::new(io), service);
        let mut connection = pin!(connection.with_upgrades());
        let mut closed = self.closed.clone();
        // The end of a connection needs no handling: the client knows which requests have no response.
        tokio::select! {
            ended = connection.as_mut() => return drop(ended),
            _ = closed.wait_for(|closed| *closed) => {}
        }
        connection.as_mut().graceful_shutdown();
        drop(connection.await);
    }
}

/// Removes the base path from a request, in case a proxy left it there.
fn without_base<B>(mut request: Request<B>, base: &BasePath) -> Request<B> {
    let rest = request.uri().path().strip_prefix(base.as_str());
    let prefix = match rest.filter(|_| !base.as_str().is_empty()) {
        Some("") => BasePrefix::Bare,
        Some(rest) if rest.starts_with('/') => BasePrefix::Whole,
        _ => return request,
    };
    let mut parts = request.uri().clone().into_parts();
    let path = rest.filter(|rest| !rest.is_empty()).unwrap_or("/");
    let query = request.uri().query().map(|query| format!("?{query}")).unwrap_or_default();
    parts.path_and_query = PathAndQuery::try_from(format!("{path}{query}")).ok();
    if let Ok(uri) = Uri::from_parts(parts) {
        *request.uri_mut() = uri;
        request.extensions_mut().insert(prefix);
    }
    request
}

/// A stream that carries requests.
trait Stream: AsyncRead + AsyncWrite + Unpin + Send + 'static {}

impl<T: AsyncRead + AsyncWrite + Unpin + Send + 'static> Stream for T {}
