//! The address in the browser: the server's own, or that of a reverse proxy in front of it. Headers of a proxy count only if the
//! settings name its address. Pure: headers in, address out.

use super::connection_slots::{Peer, from_nowhere};
use crate::Failure;
use crate::settings::{BasePath, Listen};
use axum::extract::FromRequestParts;
use axum::http::HeaderMap;
use axum::http::header::{self, HeaderName};
use axum::http::request::Parts;
use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;

const FOR: &str = "x-forwarded-for";
const HOST: &str = "x-forwarded-host";
const PORT: &str = "x-forwarded-port";
const PROTO: &str = "x-forwarded-proto";
const PREFIX: &str = "x-forwarded-prefix";

/// Prefix of the path that was removed from a request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum BasePrefix {
    /// Base path with a slash behind it.
    Whole,
    /// Base path without a slash behind it.
    Bare,
}

/// Address of this server in the browser.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct OuterAddress {
    /// True with TLS; `None` if no header reports it.
    pub(crate) is_secure: Option<bool>,
    /// Name and port in the browser.
    pub(crate) host: String,
    /// Path of the server there.
    pub(crate) base: BasePath,
    /// True if the address lacks the slash behind the path.
    pub(crate) is_bare: bool,
    /// Address of the browser.
    pub(crate) peer: Peer,
}

/// Report of a proxy about a request.
#[derive(Debug, Default)]
struct ProxyReport {
    clients: Vec<Option<IpAddr>>,
    host: Option<String>,
    is_secure: Option<bool>,
}

impl OuterAddress {
    /// Address of a request to `host` that `peer` sent.
    pub(crate) fn of(
        headers: &HeaderMap,
        host: &str,
        peer: Peer,
        prefix: Option<BasePrefix>,
        listen: &Listen,
    ) -> Result<Self, Failure> {
        let is_bare = prefix == Some(BasePrefix::Bare);
        let base = if prefix.is_some() { listen.base_path.clone() } else { BasePath::default() };
        let plain = Self { is_secure: None, host: host.to_owned(), base, is_bare, peer };
        if !listen.proxies.contains(&peer.ip) {
            // A client behind an unlisted proxy counts as remote.
            let is_near = peer.is_near && !is_forwarded(headers);
            return Ok(Self { peer: Peer { is_near, ..peer }, ..plain });
        }
        let report = ProxyReport::read(headers)?;
        let named = last(headers, PREFIX).and_then(BasePath::parse);
        let base = match prefix {
            Some(_) => plain.base,
            None => named.unwrap_or_else(|| listen.base_path.clone()),
        };
        Ok(Self {
            is_secure: report.is_secure,
            peer: report.client(peer, &listen.proxies),
            host: report.host.unwrap_or(plain.host),
            base,
            is_bare,
        })
    }
}

impl<S: Sync> FromRequestParts<S> for OuterAddress {
    type Rejection = Failure;

    async fn from_request_parts(parts: &mut Parts, _state: &S) -> Result<Self, Failure> {
        let outer = parts.extensions.get::<Arc<Self>>().ok_or_else(from_nowhere)?;
        let mut outer = Self::clone(outer);
        if outer.is_secure.is_none() {
            // The origin of a request that was admitted is the page's own.
            let origin = parts.headers.get(header::ORIGIN).and_then(|origin| origin.to_str().ok());
            outer.is_secure = origin.and_then(|origin| is_secure(origin.split_once("://")?.0));
        }
        Ok(outer)
    }
}

impl ProxyReport {
    fn read(headers: &HeaderMap) -> Result<Self, Failure> {
        let has_old = [FOR, HOST, PORT, PROTO].iter().any(|name| headers.contains_key(*name));
        match (headers.contains_key(header::FORWARDED), has_old) {
            (true, true) => Err(two_reports()),
            (true, false) => Ok(Self::of_forwarded(headers)),
            (false, _) => Ok(Self::of_old(headers)),
        }
    }

    /// From `Forwarded` (RFC 7239). The nearest proxy is the last element.
    fn of_forwarded(headers: &HeaderMap) -> Self {
        let mut report = Self::default();
        for element in values(headers, &header::FORWARDED) {
            (report.host, report.is_secure) = (None, None);
            let mut client = None;
            for (name, value) in element.split(';').filter_map(|pair| pair.split_once('=')) {
                let value = value.trim().trim_matches('"');
                match name.trim().to_ascii_lowercase().as_str() {
                    "for" => client = address(value),
                    "host" => report.host = Some(value.to_owned()),
                    "proto" => report.is_secure = is_secure(value),
                    _ => {}
                }
            }
            report.clients.push(client);
        }
        report
    }

    /// From `X-Forwarded-For` and its like.
    fn of_old(headers: &HeaderMap) -> Self {
        let clients = values(headers, &HeaderName::from_static(FOR)).map(address).collect();
        let host = last(headers, HOST).map(|host| match last(headers, PORT) {
            Some(port) if !has_port(host) => format!("{host}:{port}"),
            _ => host.to_owned(),
        });
        Self { clients, host, is_secure: last(headers, PROTO).and_then(is_secure) }
    }

    /// The last client that is not a proxy. If unknown, the client counts as remote, with the proxy's address.
    fn client(&self, proxy: Peer, proxies: &[IpAddr]) -> Peer {
        let is_proxy = |client: &Option<IpAddr>| client.is_some_and(|ip| proxies.contains(&ip));
        let client = self.clients.iter().rev().find(|client| !is_proxy(client));
        match client.or(self.clients.first()).copied().flatten() {
            Some(ip) => Peer { ip, is_near: ip.is_loopback() },
            None => Peer { is_near: false, ..proxy },
        }
    }
}

fn is_forwarded(headers: &HeaderMap) -> bool {
    let names = [FOR, HOST, PORT, PROTO, PREFIX, "forwarded", "x-real-ip", "via"];
    names.iter().any(|name| headers.contains_key(*name))
}

/// Elements of a header, over all its lines.
fn values<'h>(headers: &'h HeaderMap, name: &HeaderName) -> impl Iterator<Item = &'h str> {
    let lines = headers.get_all(name).iter().filter_map(|line| line.to_str().ok());
    lines.flat_map(|line| line.split(',')).map(str::trim)
}

fn last<'h>(headers: &'h HeaderMap, name: &'static str) -> Option<&'h str> {
    values(headers, &HeaderName::from_static(name)).last().filter(|value| !value.is_empty())
}

/// An address, with or without a port.
fn address(text: &str) -> Option<IpAddr> {
    let plain = text.trim_matches(['[', ']']).parse::<IpAddr>().ok();
    plain.or_else(|| Some(text.parse::<SocketAddr>().ok()?.ip())).map(|ip| ip.to_canonical())
}

fn has_port(host: &str) -> bool {
    host.rsplit(']').next().is_some_and(|rest| rest.contains(':'))
}

/// Some proxies name the scheme of `WebSocket`s.
fn is_secure(scheme: &str) -> Option<bool> {
    match scheme.to_ascii_lowercase().as_str() {
        "https" | "wss" => Some(true),
        "http" | "ws" => Some(false),
        _ => None,
    }
}

fn two_reports() -> Failure {
    let message = "the proxy sends `Forwarded` and `X-Forwarded-…`, one of which may come from a stranger: let it send one of \
                   them and remove the other";
    Failure::bad("two_reports", message)
}

#[cfg(test)]
mod tests {
    use super::{BasePrefix, OuterAddress};
    use crate::access::Peer;
    use crate::settings::{BasePath, Listen};
    use axum::http::{HeaderMap, HeaderName, HeaderValue};
    use expect_test::{Expect, expect};

    fn headers(lines: &str) -> HeaderMap {
        let lines = lines.lines().map(str::trim).filter(|line| !line.is_empty());
        let pairs = lines.map(|line| line.split_once(": ").unwrap());
        pairs
            .map(|(name, value)| {
                let name = HeaderName::try_from(name).unwrap();
                (name, HeaderValue::from_str(value).unwrap())
            })
            .collect()
    }

    /// Reads these headers of a proxy; the settings trust 10.0.0.1 and 127.0.0.1.
    fn check(proxy: &str, lines: &str, expect: &Expect) {
        let listen = Listen {
            proxies: vec!["10.0.0.1".parse().unwrap(), "127.0.0.1".parse().unwrap()],
            base_path: BasePath::parse("/robot").unwrap(),
            ..Listen::default()
        };
        let ip: std::net::IpAddr = proxy.parse().unwrap();
        let peer = Peer { ip, is_near: ip.is_loopback() };
        let outer = OuterAddress::of(&headers(lines), "inner:4747", peer, None, &listen);
        expect.assert_eq(&match outer {
            Ok(OuterAddress { is_secure, host, base, peer, .. }) => {
                let near = if peer.is_near { " near" } else { "" };
                format!("{is_secure:?} {host} {} {}{near}", base.as_str(), peer.ip)
            }
            Err(failure) => failure.code().to_owned(),
        });
    }

    #[test]
    fn a_trusted_proxy_says_what_the_browser_has_in_its_address() {
        let old = "X-Forwarded-For: 192.0.2.7
                   X-Forwarded-Host: robot.lan
                   X-Forwarded-Proto: https";
        check("10.0.0.1", old, &expect!["Some(true) robot.lan /robot 192.0.2.7"]);
        check(
            "10.0.0.1",
            "Forwarded: for=192.0.2.60;proto=http;by=203.0.113.43, For=\"[2001:db8::7]:9\";Proto=https;host=\"robot.lan:8443\"",
            &expect!["Some(true) robot.lan:8443 /robot 2001:db8::7"],
        );
        let port = "X-Forwarded-Host: robot.lan
                    X-Forwarded-Port: 8443
                    X-Forwarded-Proto: wss
                    X-Forwarded-Prefix: /fleet/one/";
        check("127.0.0.1", port, &expect!["Some(true) robot.lan:8443 /fleet/one 127.0.0.1"]);
    }

    #[test]
    fn the_client_is_the_last_one_that_is_no_proxy() {
        let chain = "X-Forwarded-For: 127.0.0.1, 192.0.2.7
                     X-Forwarded-For: 10.0.0.1";
        check("127.0.0.1", chain, &expect!["None inner:4747 /robot 192.0.2.7"]);
        let own = "X-Forwarded-For: 127.0.0.1";
        check("127.0.0.1", own, &expect!["None inner:4747 /robot 127.0.0.1 near"]);
        let hidden = "Forwarded: for=127.0.0.1, for=_hidden";
        check("127.0.0.1", hidden, &expect!["None inner:4747 /robot 127.0.0.1"]);
        check("127.0.0.1", "", &expect!["None inner:4747 /robot 127.0.0.1"]);
    }

    #[test]
    fn what_a_stranger_says_counts_for_nothing() {
        let lies = "X-Forwarded-For: 127.0.0.1
                    X-Forwarded-Host: evil.example
                    X-Forwarded-Proto: https
                    X-Forwarded-Prefix: /evil";
        check("192.0.2.7", lies, &expect!["None inner:4747  192.0.2.7"]);
        check("127.0.0.2", lies, &expect!["None inner:4747  127.0.0.2"]);
        check("127.0.0.2", "", &expect!["None inner:4747  127.0.0.2 near"]);
        let both = "Forwarded: for=127.0.0.1
                    X-Forwarded-For: 192.0.2.7";
        check("10.0.0.1", both, &expect!["two_reports"]);
        let prefix = "X-Forwarded-For: 192.0.2.7
                      X-Forwarded-Prefix: //evil.example";
        check("10.0.0.1", prefix, &expect!["None inner:4747 /robot 192.0.2.7"]);
    }

    #[test]
    fn a_path_that_began_with_the_base_path_is_below_it() {
        let listen = Listen { base_path: BasePath::parse("robot/").unwrap(), ..Listen::default() };
        let peer = Peer { ip: "127.0.0.1".parse().unwrap(), is_near: true };
        let of = |prefix| OuterAddress::of(&HeaderMap::new(), "a", peer, prefix, &listen).unwrap();
        assert_eq!(of(Some(BasePrefix::Whole)).base.as_str(), "/robot");
        assert!(of(Some(BasePrefix::Bare)).is_bare);
        assert_eq!(of(None).base.as_str(), "");
    }
}
