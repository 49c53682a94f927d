//! The server behind a real reverse proxy, nginx, as seen by a browser: page, login, requests and the WebSocket. The
//! configurations are those in `docs/guide/server.md`.

use crate::harness::{PASSWORD, TestServer};
use crate::page::page;
use rafcon_server::settings::BasePath;
use rafcon_server::{PageFiles, Settings};
use rustix::io::{FdFlags, fcntl_setfd};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::{Value, json};
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::os::fd::AsRawFd as _;
use std::path::Path;
use std::process::{Child, Command};
use std::sync::Arc;
use std::time::Duration;
use tempfile::TempDir;
use tokio_rustls::rustls::crypto::ring::default_provider;
use tokio_rustls::rustls::pki_types::pem::PemObject as _;
use tokio_rustls::rustls::pki_types::{CertificateDer, ServerName};
use tokio_rustls::rustls::{ClientConfig, ClientConnection, RootCertStore, StreamOwned};
use tungstenite::Message;
use tungstenite::client::IntoClientRequest as _;

/// Far longer than any response takes.
const TEST_TIMEOUT: Duration = Duration::from_secs(15);
/// Set on computers where a missing program is a fault.
const CI: &str = "CI";

/// Header lines of a proxy about the browser.
const TOLD: &str = "proxy_set_header X-Forwarded-For $remote_addr;
                    proxy_set_header X-Forwarded-Host $http_host;
                    proxy_set_header X-Forwarded-Proto $scheme;";

/// A proxy that runs until dropped.
struct Nginx {
    place: TempDir,
    port: u16,
    child: Child,
}

/// Address of the server at a proxy.
struct Offer<'o> {
    is_secure: bool,
    /// `location` and `proxy_pass`; `SERVER` is replaced by the server's address.
    location: &'o str,
}

/// A browser that uses the proxy.
struct Browser<'n> {
    nginx: &'n Nginx,
    is_secure: bool,
    /// Name and port in its address.
    host: String,
    base: &'n str,
}

trait Wire: Read + Write {}

impl<T: Read + Write> Wire for T {}

impl Nginx {
    /// Starts nginx. `None` if it is not installed.
    fn start(server: &TestServer, offer: &Offer<'_>) -> Option<Self> {
        let program =
            ["/usr/sbin/nginx", "/usr/bin/nginx"].into_iter().find(|it| Path::new(it).exists());
        let Some(program) = program else {
            assert!(
                std::env::var_os(CI).is_none(),
                "nginx is not installed: apt-get install nginx-light"
            );
            return None;
        };
        let place = tempfile::tempdir().unwrap();
        // The proxy inherits the socket, which accepts connections from now on.
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        listener.set_nonblocking(true).unwrap();
        fcntl_setfd(&listener, FdFlags::empty()).unwrap();
        let port = listener.local_addr().unwrap().port();
        std::fs::write(place.path().join("nginx.conf"), config(server, offer, port)).unwrap();
        let made = rcgen::generate_simple_self_signed(["robot.lan".to_owned()]).unwrap();
        std::fs::write(place.path().join("certificate.pem"), made.cert.pem()).unwrap();
        std::fs::write(place.path().join("key.pem"), made.signing_key.serialize_pem()).unwrap();
        let child = Command::new(program)
            .args(["-c", "nginx.conf", "-e", "error.log", "-p"])
            .arg(place.path())
            .env("NGINX", format!("{};", listener.as_raw_fd()))
            .spawn()
            .unwrap();
        Some(Self { place, port, child })
    }

    fn connect(&self, is_secure: bool) -> Box<dyn Wire> {
        let stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream.set_read_timeout(Some(TEST_TIMEOUT)).unwrap();
        if !is_secure {
            return Box::new(stream);
        }
        let certificate = CertificateDer::from_pem_file(self.place.path().join("certificate.pem"));
        let mut roots = RootCertStore::empty();
        roots.add(certificate.unwrap()).unwrap();
        let builder = ClientConfig::builder_with_provider(Arc::new(default_provider()));
        let builder = builder.with_safe_default_protocol_versions().unwrap();
        let config = Arc::new(builder.with_root_certificates(roots).with_no_client_auth());
        let name = ServerName::try_from("robot.lan").unwrap();
        Box::new(StreamOwned::new(ClientConnection::new(config, name).unwrap(), stream))
    }
}

impl Drop for Nginx {
    fn drop(&mut self) {
        // The worker process ends with it.
        kill_process(Pid::from_child(&self.child), Signal::TERM).unwrap();
        self.child.wait().unwrap();
    }
}

fn config(server: &TestServer, offer: &Offer<'_>, port: u16) -> String {
    let tls = "ssl_certificate certificate.pem; ssl_certificate_key key.pem;";
    let (ssl, tls) = if offer.is_secure { (" ssl", tls) } else { ("", "") };
    let location = offer.location.replace("SERVER", &server.address().to_string());
    // Headers in a location replace those of the enclosing blocks.
    let location = location.replace(
        "proxy_pass",
        "proxy_set_header Upgrade $http_upgrade; proxy_set_header Connection $connection_upgrade; proxy_pass",
    );
    format!(
        "daemon off; user root; pid nginx.pid;
         events {{}}
         http {{
             access_log off; client_body_temp_path body; proxy_temp_path proxy;
             fastcgi_temp_path fastcgi; uwsgi_temp_path uwsgi; scgi_temp_path scgi;
             map $http_upgrade $connection_upgrade {{ default upgrade; '' ''; }}
             server {{
                 listen 127.0.0.1:{port}{ssl}; {tls}
                 proxy_http_version 1.1;
                 {location}
             }}
         }}"
    )
}

impl Browser<'_> {
    fn origin(&self) -> String {
        let scheme = if self.is_secure { "https" } else { "http" };
        format!("{scheme}://{}", self.host)
    }

    /// The response to a request with these header lines.
    fn ask(&self, line: &str, head: &[(&str, &str)], body: &str) -> String {
        let head = head.iter().map(|(name, value)| format!("{name}: {value}\r\n"));
        let request = format!(
            "{line} HTTP/1.1\r\nHost: {}\r\nConnection: close\r\n{}Content-Type: application/json\r\n\
             Content-Length: {}\r\n\r\n{body}",
            self.host,
            head.collect::<String>(),
            body.len()
        );
        let mut wire = self.nginx.connect(self.is_secure);
        wire.write_all(request.as_bytes()).unwrap();
        let (mut answer, mut part) = (Vec::new(), [0; 4096]);
        while let Ok(count @ 1..) = wire.read(&mut part) {
            answer.extend_from_slice(&part[..count]);
        }
        String::from_utf8_lossy(&answer).into_owned()
    }

    fn log_in(&self, origin: &str) -> String {
        let login = json!({ "user": "engineer", "password": PASSWORD }).to_string();
        let head = [("Origin", origin), ("Sec-Fetch-Site", "same-origin")];
        self.ask(&format!("POST {}/api/v1/session", self.base), &head, &login)
    }

    /// The first frames of a WebSocket with a subscription to the server's status.
    fn follow(&self, cookie: &str) -> [Value; 2] {
        let scheme = if self.is_secure { "wss" } else { "ws" };
        let url = format!("{scheme}://{}{}/api/v1/socket", self.host, self.base);
        let mut request = url.into_client_request().unwrap();
        request.headers_mut().insert("cookie", cookie.parse().unwrap());
        request.headers_mut().insert("origin", self.origin().parse().unwrap());
        let wire = self.nginx.connect(self.is_secure);
        let (mut socket, _) =
            tungstenite::client(request, wire).map_err(|error| error.to_string()).unwrap();
        let topic = json!({ "topic": "server_status" });
        let subscribe = json!({ "frame": "subscribe", "subscription": 1, "topic": topic });
        socket.send(Message::text(subscribe.to_string())).unwrap();
        let mut hear = || serde_json::from_str(socket.read().unwrap().to_text().unwrap()).unwrap();
        [hear(), hear()]
    }

    /// All steps of a page, from its address to a subscription.
    fn visit(&self) {
        let base = self.base;
        let index = self.ask(&format!("GET {base}/"), &[("Accept", "text/html")], "");
        assert!(index.starts_with("HTTP/1.1 200"), "{index}");
        let asset = index.split_once("src=\"").unwrap_or_else(|| panic!("{index}")).1;
        let asset = asset.split_once('"').unwrap().0;
        let asset =
            asset.strip_prefix("./").map_or_else(|| asset.to_owned(), |it| format!("{base}/{it}"));
        let file = self.ask(&format!("GET {asset}"), &[], "");
        assert!(file.starts_with("HTTP/1.1 200") && file.ends_with("let a"), "{asset}: {file}");
        let entered = self.log_in(&self.origin());
        assert!(entered.starts_with("HTTP/1.1 200"), "{entered}");
        let cookie = header(&entered, "set-cookie").unwrap();
        assert_eq!(cookie.contains("; Secure"), self.is_secure, "{cookie}");
        let pair = cookie.split(';').next().unwrap();
        let session = self.ask(&format!("GET {base}/api/v1/session"), &[("Cookie", pair)], "");
        assert!(session.contains(r#""user":"engineer""#), "{session}");
        let [welcome, status] = self.follow(pair);
        assert_eq!(
            (&welcome["frame"], &status["frame"]),
            (&json!("welcome"), &json!("server_status"))
        );
        self.check_closed_to_others();
    }

    /// Pages of other sites and other host names are refused.
    fn check_closed_to_others(&self) {
        let strange = self.log_in("https://evil.example");
        assert!(strange.starts_with("HTTP/1.1 403"), "{strange}");
        let other = Browser { nginx: self.nginx, host: "evil.example".to_owned(), ..*self };
        let other = other.ask(&format!("GET {}/", self.base), &[("Accept", "text/html")], "");
        assert!(other.starts_with("HTTP/1.1 421"), "{other}");
        assert!(other.contains("this page was opened at `evil.example`"), "{other}");
    }
}

fn header(answer: &str, name: &str) -> Option<String> {
    let head = answer.split("\r\n\r\n").next()?;
    let mut lines = head.lines().filter_map(|line| line.split_once(": "));
    lines.find(|(other, _)| other.eq_ignore_ascii_case(name)).map(|(_, value)| value.to_owned())
}

/// A server with the host name `robot.lan`, and a page with one file.
fn server(change: impl FnOnce(&mut Settings)) -> (TempDir, TestServer) {
    let place = tempfile::tempdir().unwrap();
    let files = page(place.path());
    let PageFiles::Folder(folder) = &files else { unreachable!() };
    let html = r#"<meta name="base" content="./" /><script src="./assets/a-1.js"></script>"#;
    std::fs::write(folder.join("index.html"), html).unwrap();
    let server = TestServer::with(|settings| {
        settings.page = files;
        settings.listen.hosts = vec!["robot.lan".to_owned()];
        change(settings);
    });
    (place, server)
}

fn trusting(settings: &mut Settings) {
    settings.listen.proxies = vec!["127.0.0.1".parse().unwrap()];
}

fn below_robot(settings: &mut Settings) {
    settings.listen.base_path = BasePath::parse("/robot").unwrap();
}

const AT_ROOT: &str = "location / { proxy_pass http://SERVER; proxy_set_header Host $http_host; }";

#[test]
fn another_port_needs_no_more_than_the_name() {
    let (_place, server) = server(|_settings| {});
    let offer = Offer { is_secure: false, location: AT_ROOT };
    let Some(nginx) = Nginx::start(&server, &offer) else { return };
    for host in ["robot.lan".to_owned(), format!("robot.lan:{}", nginx.port)] {
        Browser { nginx: &nginx, is_secure: false, host, base: "" }.visit();
    }
}

#[test]
fn a_proxy_may_end_tls() {
    let told = format!(
        "location / {{ proxy_pass http://SERVER; proxy_set_header Host $http_host; {TOLD} }}"
    );
    for (location, change) in [(AT_ROOT, None), (told.as_str(), Some(trusting))] {
        let (_place, server) =
            server(|settings| change.into_iter().for_each(|change| change(settings)));
        let Some(nginx) = Nginx::start(&server, &Offer { is_secure: true, location }) else {
            return;
        };
        for host in ["robot.lan", "robot.lan:8443"] {
            let host = host.to_owned();
            Browser { nginx: &nginx, is_secure: true, host, base: "" }.visit();
        }
        if change.is_some() {
            let plain = "http://robot.lan";
            let browser =
                Browser { nginx: &nginx, is_secure: true, host: "robot.lan".to_owned(), base: "" };
            assert!(
                browser.log_in(plain).starts_with("HTTP/1.1 403"),
                "another scheme is another page"
            );
        }
    }
}

#[test]
fn a_proxy_may_keep_the_prefix_of_the_path() {
    let (_place, server) = server(below_robot);
    let location =
        "location /robot { proxy_pass http://SERVER; proxy_set_header Host $http_host; }";
    let Some(nginx) = Nginx::start(&server, &Offer { is_secure: true, location }) else { return };
    let browser =
        Browser { nginx: &nginx, is_secure: true, host: "robot.lan".to_owned(), base: "/robot" };
    browser.visit();
    let bare = browser.ask("GET /robot?run=1&token=x", &[], "");
    assert_eq!(header(&bare, "location").as_deref(), Some("/robot/?run=1"), "{bare}");
    let cookie = header(&browser.log_in(&browser.origin()), "set-cookie").unwrap();
    assert!(cookie.contains("; Path=/robot/;"), "{cookie}");
}

#[test]
fn a_proxy_may_take_the_prefix_off_the_path() {
    let plain = "location /robot/ { proxy_pass http://SERVER/; proxy_set_header Host $http_host; }";
    let told = format!(
        "location /robot/ {{ proxy_pass http://SERVER/; proxy_set_header Host $http_host; {TOLD}
             proxy_set_header X-Forwarded-Prefix /robot; }}"
    );
    for (location, change, path) in [(plain, None, "/"), (told.as_str(), Some(trusting), "/robot/")]
    {
        let (_place, server) =
            server(|settings| change.into_iter().for_each(|change| change(settings)));
        let Some(nginx) = Nginx::start(&server, &Offer { is_secure: true, location }) else {
            return;
        };
        let host = "robot.lan".to_owned();
        let browser = Browser { nginx: &nginx, is_secure: true, host, base: "/robot" };
        browser.visit();
        let cookie = header(&browser.log_in(&browser.origin()), "set-cookie").unwrap();
        assert!(cookie.contains(&format!("; Path={path};")), "{cookie}");
    }
}

#[test]
fn a_proxy_that_is_trusted_may_call_the_server_by_another_name() {
    let (_place, server) = server(trusting);
    let location = format!("location / {{ proxy_pass http://SERVER; {TOLD} }}");
    let offer = Offer { is_secure: true, location: &location };
    let Some(nginx) = Nginx::start(&server, &offer) else { return };
    let browser =
        Browser { nginx: &nginx, is_secure: true, host: "robot.lan:8443".to_owned(), base: "" };
    browser.visit();
    let bearer = format!("Bearer {}", server.owner());
    let owner = browser.ask("GET /api/v1/session", &[("Authorization", &bearer)], "");
    assert!(owner.starts_with("HTTP/1.1 200"), "the browser is on this computer: {owner}");
}

#[test]
fn without_trust_a_page_is_told_what_its_proxy_lacks() {
    let (_place, server) = server(|_settings| {});
    let location = format!("location / {{ proxy_pass http://SERVER; {TOLD} }}");
    let offer = Offer { is_secure: true, location: &location };
    let Some(nginx) = Nginx::start(&server, &offer) else { return };
    let browser =
        Browser { nginx: &nginx, is_secure: true, host: "robot.lan".to_owned(), base: "" };
    let refused = browser.log_in(&browser.origin());
    assert!(refused.starts_with("HTTP/1.1 403"), "{refused}");
    let words = "this page was opened at https://robot.lan, but the server was called";
    assert!(refused.contains(words) && refused.contains("--trusted-proxy"), "{refused}");
    let bearer = format!("Bearer {}", server.owner());
    let owner = browser.ask("GET /api/v1/session", &[("Authorization", &bearer)], "");
    assert!(owner.starts_with("HTTP/1.1 401"), "who comes through a proxy is not here: {owner}");
}
