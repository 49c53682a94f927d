//! Connections: so many at a time, each with a limit on how long it may take to say something. Knows streams; knows nothing of
//! what is asked over them.

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

/// So many bytes wait in the kernel for a client that does not read them; enough for 0.5 Mbit/s at a round trip of 4 s.
const SEND_BUFFER: usize = 256 * 1024;

/// Wait for the files of connections that lost their place.
const CLOSE_TIMEOUT: Duration = Duration::from_millis(100);

/// Minimum interval between reports of a shortage in the log.
pub(super) const REPORT_INTERVAL: Duration = Duration::from_mins(1);

/// All connections of a server.
pub(super) struct Connections {
    places: ConnectionSlots,
    service: RequestService,
}

/// How one connection is answered.
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

    /// Answers one connection. Where no place is free it is closed at once.
    pub(super) fn begin(&self, stream: TcpStream, peer: SocketAddr, router: Router) {
        let peer = Peer::of(peer, stream.local_addr().ok());
        let Some((place, lost)) = self.places.take(peer) else { return };
        // Without it an answer in two parts waits for the other side's acknowledgement.
        stream.set_nodelay(true).unwrap_or_default();
        // What a client does not read waits in the kernel's memory, and there are many clients.
        set_socket_send_buffer_size(&stream, SEND_BUFFER).unwrap_or_default();
        let io = Paced::new(stream, self.service.write_limit, (Arc::clone(&place), lost));
        let service = self.service.clone();
        tokio::spawn(async move { service.welcome(io, (peer, place), router).await });
    }

    /// Waits until a new connection has a file: those that lost their place close theirs soon.
    pub(super) async fn room(&self) {
        self.places.wait_until_closed(CLOSE_TIMEOUT).await;
    }

    /// Reports in the log that no place was free, at most once per interval.
    #[expect(clippy::infinite_loop, reason = "it ends by being dropped, as futures do")]
    pub(super) async fn report(&self, log: fn(&str)) {
        let Capacity { all, anonymous } = self.places.capacity();
        let mut crowded_out = self.places.crowded_out();
        loop {
            // The sender lives as long as we do.
            drop(crowded_out.changed().await);
            let count = *crowded_out.borrow_and_update();
            log(&format!(
                "too many connections ({all} at most, {anonymous} of them without a login, a quarter from one other network): \
                 each new one ends the oldest without a login; {count} were ended or refused since the start"
            ));
            sleep(REPORT_INTERVAL).await;
        }
    }

    /// Waits until all are gone, but not for ever.
    pub(super) async fn gone(&self, patience: Duration) {
        self.places.wait_until_free(patience).await;
    }
}

impl RequestService {
    /// Where there is TLS, a client has so long to speak it.
    async fn welcome(
        self,
        io: Paced<TcpStream>,
        from: (Peer, Arc<ConnectionSlot>),
        router: Router,
    ) {
        let Some(tls) = &self.tls else { return self.answer(io, from, router).await };
        if let Ok(Ok(io)) = timeout(self.patience, tls.accept(io)).await {
            self.answer(io, from, router).await;
        }
    }

    async fn answer(
        &self,
        io: impl Stream,
        (peer, place): (Peer, Arc<ConnectionSlot>),
        router: Router,
    ) {
        let router = AddExtension::new(AddExtension::new(router, peer), place);
        let service = TowerToHyperService::new(router);
        let base = self.base.clone();
        let service = service_fn(move |request| service.call(without_base(request, &base)));
        let connection = self.http.serve_connection(TokioIo::new(io), service);
        let mut connection = pin!(connection.with_upgrades());
        let mut closed = self.closed.clone();
        // How a connection ended is the client's business: it knows what it was not answered.
        tokio::select! {
            ended = connection.as_mut() => return drop(ended),
            _ = closed.wait_for(|closed| *closed) => {}
        }
        connection.as_mut().graceful_shutdown();
        drop(connection.await);
    }
}

/// The request without the base path, which a proxy may have left in its path.
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

/// What requests come over.
trait Stream: AsyncRead + AsyncWrite + Unpin + Send + 'static {}

impl<T: AsyncRead + AsyncWrite + Unpin + Send + 'static> Stream for T {}
