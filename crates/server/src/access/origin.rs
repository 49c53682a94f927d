//! The names by which this server answers, and the pages from which requests may come. Pure: headers in, yes or no out.
//!
//! A stranger's page can make a browser send requests to this computer. It cannot make the browser lie about the name it
//! called (`Host`) or the page that asked (`Origin`).

use std::net::IpAddr;

/// What a server is called by its clients.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Names {
    /// The port it listens on.
    pub(crate) port: u16,
    /// Whether it speaks TLS.
    pub(crate) is_secure: bool,
    /// Whether only programs on this computer reach it.
    pub(crate) is_loopback: bool,
    /// Its names and addresses, in lower case.
    pub(crate) hosts: Vec<String>,
}

impl Names {
    /// The names of a server that does not listen.
    pub(crate) fn nobody() -> Self {
        Self { port: 0, is_secure: false, is_loopback: true, hosts: Vec::new() }
    }

    /// The scheme of its addresses.
    pub(crate) fn scheme(&self) -> &'static str {
        if self.is_secure { "https" } else { "http" }
    }

    /// Whether `host`, as a `Host` header gives it, means this server.
    pub(crate) fn answers_to(&self, host: &str) -> bool {
        let usual = if self.is_secure { 443 } else { 80 };
        let Some((name, port)) = parted(host) else { return false };
        port.unwrap_or(usual) == self.port && self.is_called(&name)
    }

    /// The owner of a name can point it anywhere; an address cannot be redirected.
    fn is_called(&self, name: &str) -> bool {
        let address = name.parse::<IpAddr>().ok();
        self.hosts.iter().any(|host| host == name)
            || address.is_some_and(|address| !self.is_loopback || address.is_loopback())
    }

    /// Whether a page of this origin is this server's own, called by the same name.
    pub(crate) fn is_own(&self, origin: &str, host: &str) -> bool {
        let own = origin.split_once("://").filter(|(scheme, _)| *scheme == self.scheme());
        own.is_some_and(|(_, rest)| rest.eq_ignore_ascii_case(host))
    }
}

/// Name and port of `name:port`, `name` or `[address]:port`.
fn parted(host: &str) -> Option<(String, Option<u16>)> {
    let (name, port) = match host.strip_prefix('[') {
        Some(rest) => rest.split_once(']')?,
        None => host.split_once(':').map_or((host, ""), |(name, _)| (name, &host[name.len()..])),
    };
    let port = match port.strip_prefix(':') {
        Some(port) => Some(port.parse().ok()?),
        None if port.is_empty() => None,
        None => return None,
    };
    Some((name.to_ascii_lowercase(), port))
}

#[cfg(test)]
mod tests {
    use super::Names;
    use expect_test::{Expect, expect};

    fn names(is_loopback: bool, hosts: &[&str]) -> Names {
        let hosts = hosts.iter().map(|host| (*host).to_owned()).collect();
        Names { port: 4747, is_secure: !is_loopback, is_loopback, hosts }
    }

    fn check(names: &Names, hosts: &str, expected: &Expect) {
        let line =
            |host: &str| format!("{host} {}\n", if names.answers_to(host) { "yes" } else { "no" });
        expected.assert_eq(&hosts.split_whitespace().map(line).collect::<String>());
    }

    #[test]
    fn on_the_loopback_only_its_own_names_count() {
        check(
            &names(true, &["localhost"]),
            "localhost:4747 LOCALHOST:4747 127.0.0.1:4747 [::1]:4747 localhost localhost:80 \
             evil.example:4747 192.168.0.7:4747 [::1 [::1]x :4747 localhost:99999",
            &expect![[r"
                localhost:4747 yes
                LOCALHOST:4747 yes
                127.0.0.1:4747 yes
                [::1]:4747 yes
                localhost no
                localhost:80 no
                evil.example:4747 no
                192.168.0.7:4747 no
                [::1 no
                [::1]x no
                :4747 no
                localhost:99999 no
            "]],
        );
    }

    #[test]
    fn elsewhere_addresses_and_given_names_count() {
        check(
            &names(false, &["rover.lan", "localhost"]),
            "rover.lan:4747 192.168.0.7:4747 [fe80::1]:4747 evil.example:4747",
            &expect![[r"
                rover.lan:4747 yes
                192.168.0.7:4747 yes
                [fe80::1]:4747 yes
                evil.example:4747 no
            "]],
        );
    }

    #[test]
    fn a_page_is_ones_own_by_scheme_name_and_port() {
        let names = names(true, &["localhost"]);
        assert!(names.is_own("http://localhost:4747", "localhost:4747"));
        assert!(!names.is_own("https://localhost:4747", "localhost:4747"));
        assert!(!names.is_own("http://localhost:3000", "localhost:4747"));
        assert!(!names.is_own("http://127.0.0.1:4747", "localhost:4747"));
        assert!(!names.is_own("null", "localhost:4747"));
    }
}
