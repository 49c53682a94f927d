//! The address of a server, as people write it. Pure.

use std::fmt;
use std::net::IpAddr;

/// Default port of a server.
const USUAL_PORT: u16 = 4747;

/// Scheme, host and port of a server, and its base path behind a reverse proxy.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Address {
    /// True for a server with TLS.
    pub(crate) is_secure: bool,
    /// Name or IP address; an IPv6 address without brackets.
    pub(crate) host: String,
    pub(crate) port: u16,
    /// The path, such as `/robot`; empty without one.
    pub(crate) base: String,
}

impl Address {
    /// Parses `http://HOST:PORT/PATH`, and the token at the end of a start link.
    pub(crate) fn parse(text: &str) -> Result<(Self, Option<String>), String> {
        let wrong = |why: &str| {
            format!("--server {}: {why}; write https://HOST:{USUAL_PORT}", without_token(text))
        };
        let (is_secure, rest) = match text.split_once("://") {
            Some(("https", rest)) => (true, rest),
            Some(("http", rest)) => (false, rest),
            Some((scheme, _)) => {
                return Err(wrong(&format!("the scheme `{scheme}` is not supported")));
            }
            None => return Err(wrong("http:// or https:// is missing")),
        };
        let (place, query) = rest.split_once('?').unwrap_or((rest, ""));
        let (place, path) = place.split_once('/').unwrap_or((place, ""));
        let base = base(path)
            .ok_or_else(|| wrong(&format!("`/{path}` is no path of a server behind a proxy")))?;
        let (host, port) = parted(place).ok_or_else(|| wrong("the host or the port is missing"))?;
        let token = query.split('&').find_map(|part| part.strip_prefix("token="));
        Ok((Self { is_secure, host, port, base }, token.map(str::to_owned)))
    }

    /// True for an address of this computer itself.
    pub(crate) fn is_loopback(&self) -> bool {
        let number = self.host.parse::<IpAddr>().ok();
        self.host == "localhost" || number.is_some_and(|number| number.is_loopback())
    }

    /// Host and port in the form for requests.
    pub(crate) fn authority(&self) -> String {
        let Self { host, port, .. } = self;
        if host.contains(':') { format!("[{host}]:{port}") } else { format!("{host}:{port}") }
    }

    /// Scheme, host and port: the `Origin` header of a request.
    pub(crate) fn origin(&self) -> String {
        let scheme = if self.is_secure { "https" } else { "http" };
        format!("{scheme}://{}", self.authority())
    }

    /// The address of a WebSocket.
    pub(crate) fn of_socket(&self, path: &str) -> String {
        let scheme = if self.is_secure { "wss" } else { "ws" };
        format!("{scheme}://{}{}{path}", self.authority(), self.base)
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.origin(), self.base)
    }
}

/// Removes the token: errors must not repeat secrets.
fn without_token(text: &str) -> &str {
    text.split('?').next().unwrap_or_default()
}

/// The path without its last slash. `None` if a part is empty, `.` or `..`, or needs encoding.
fn base(path: &str) -> Option<String> {
    let path = path.strip_suffix('/').unwrap_or(path);
    if path.is_empty() {
        return Some(String::new());
    }
    let fits = |c: char| c.is_ascii_alphanumeric() || "-._~".contains(c);
    let is_part = |part: &str| !["", ".", ".."].contains(&part) && part.chars().all(fits);
    path.split('/').all(is_part).then(|| format!("/{path}"))
}

fn parted(place: &str) -> Option<(String, u16)> {
    let (host, port) = match place.strip_prefix('[') {
        Some(rest) => rest.split_once(']')?,
        None => place.find(':').map_or((place, ""), |colon| place.split_at(colon)),
    };
    let port = match port.strip_prefix(':') {
        Some(port) => port.parse().ok()?,
        None if port.is_empty() => USUAL_PORT,
        None => return None,
    };
    let fits = |c: char| c.is_ascii_alphanumeric() || ".-_:%".contains(c);
    (!host.is_empty() && host.chars().all(fits)).then(|| (host.to_ascii_lowercase(), port))
}

#[cfg(test)]
mod tests {
    use super::Address;
    use expect_test::{Expect, expect};

    fn check(text: &str, expect: &Expect) {
        expect.assert_eq(&match Address::parse(text) {
            Ok((address, token)) => {
                format!("{address} {} {token:?} {}", address.of_socket("/s"), address.is_loopback())
            }
            Err(error) => error,
        });
    }

    #[test]
    fn an_address_is_scheme_host_port_and_the_path_of_a_proxy() {
        check(
            "https://Rover.lan",
            &expect![[r"https://rover.lan:4747 wss://rover.lan:4747/s None false"]],
        );
        check(
            "http://127.0.0.1:80/",
            &expect![[r"http://127.0.0.1:80 ws://127.0.0.1:80/s None true"]],
        );
        check("http://[::1]:4748", &expect![[r"http://[::1]:4748 ws://[::1]:4748/s None true"]]);
        check(
            "http://localhost:4747/?token=abc",
            &expect![[r#"http://localhost:4747 ws://localhost:4747/s Some("abc") true"#]],
        );
        check(
            "https://fleet.lan:443/robots/rover/?token=abc",
            &expect![[
                r#"https://fleet.lan:443/robots/rover wss://fleet.lan:443/robots/rover/s Some("abc") false"#
            ]],
        );
    }

    #[test]
    fn what_is_no_address_is_refused_and_no_token_is_repeated() {
        check(
            "rover",
            &expect!["--server rover: http:// or https:// is missing; write https://HOST:4747"],
        );
        check(
            "ftp://rover",
            &expect![
                "--server ftp://rover: the scheme `ftp` is not supported; write https://HOST:4747"
            ],
        );
        check(
            "http://rover:x/?token=abc",
            &expect![
                "--server http://rover:x/: the host or the port is missing; write https://HOST:4747"
            ],
        );
        check(
            "http://rover:1/../runs?token=abc",
            &expect![
                "--server http://rover:1/../runs: `/../runs` is no path of a server behind a proxy; write https://HOST:4747"
            ],
        );
        check(
            "http://",
            &expect!["--server http://: the host or the port is missing; write https://HOST:4747"],
        );
        check(
            "http://u:p@rover",
            &expect![
                "--server http://u:p@rover: the host or the port is missing; write https://HOST:4747"
            ],
        );
    }
}
