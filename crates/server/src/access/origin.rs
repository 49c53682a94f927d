//! Host names of this server, and pages from which requests may come. Pure: headers in, yes or no out.
//!
//! A page of another site can make a browser send requests to this computer. It cannot forge the requested name (`Host`) or
//! the requesting page (`Origin`).

use super::outer_address::OuterAddress;
use std::net::IpAddr;

/// Names, port and scheme under which clients reach the server.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Names {
    /// The port it listens on.
    pub(crate) port: u16,
    /// True if the server uses TLS.
    pub(crate) is_secure: bool,
    /// True if only programs on this computer can reach the server.
    pub(crate) is_loopback: bool,
    /// Its names and addresses, in lower case, valid with its port.
    pub(crate) hosts: Vec<String>,
    /// Configured names, in lower case, valid with every port, which may be that of a proxy.
    pub(crate) given: Vec<String>,
}

impl Names {
    /// The names of a server that does not listen.
    pub(crate) fn nobody() -> Self {
        let (hosts, given) = (Vec::new(), Vec::new());
        Self { port: 0, is_secure: false, is_loopback: true, hosts, given }
    }

    /// The scheme of its addresses.
    pub(crate) fn scheme(&self) -> &'static str {
        if self.is_secure { "https" } else { "http" }
    }

    /// True if `host`, the value of a `Host` header, names this server.
    pub(crate) fn answers_to(&self, host: &str) -> bool {
        let Some((name, port)) = parted(host) else { return false };
        self.given.contains(&name) || self.is_direct(&name, port)
    }

    /// True for this server's own address, without a proxy.
    fn is_direct(&self, name: &str, port: Option<u16>) -> bool {
        port.unwrap_or(usual_port(self.is_secure)) == self.port && self.is_called(name)
    }

    /// Accepted addresses, for an error.
    pub(crate) fn accepted(&self) -> String {
        let scheme = self.scheme();
        let own = self.hosts.iter().map(|host| format!("{scheme}://{host}:{}", self.port));
        let given = self.given.iter().map(|host| format!("{host} with any port"));
        own.chain(given).collect::<Vec<_>>().join(", ")
    }

    /// True for a known name, and for an address that can be this server's: unlike a name, no owner can redirect an address.
    fn is_called(&self, name: &str) -> bool {
        let address = name.parse::<IpAddr>().ok();
        self.hosts.iter().any(|host| host == name)
            || address.is_some_and(|address| !self.is_loopback || address.is_loopback())
    }

    /// True for a page that this server served under the requested name and port. The scheme must match, too, unless a proxy may have
    /// ended TLS without a report.
    pub(crate) fn is_own(&self, origin: &str, outer: &OuterAddress) -> bool {
        let Some((scheme, page)) = origin.split_once("://") else { return false };
        let is_secure = match scheme {
            "https" => true,
            "http" => false,
            _ => return false,
        };
        let (Some((name, port)), Some((page, page_port))) = (parted(&outer.host), parted(page))
        else {
            return false;
        };
        let known = outer.is_secure.or(self.is_secure.then_some(true));
        let known = known.or_else(|| self.is_direct(&name, port).then_some(false));
        let or_usual = |port: Option<u16>| port.unwrap_or(usual_port(is_secure));
        known.is_none_or(|known| known == is_secure)
            && name == page
            && or_usual(port) == or_usual(page_port)
    }
}

fn usual_port(is_secure: bool) -> u16 {
    if is_secure { 443 } else { 80 }
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
    use super::{Names, OuterAddress};
    use crate::access::Peer;
    use crate::settings::BasePath;
    use expect_test::{Expect, expect};

    fn names(is_loopback: bool, hosts: &[&str]) -> Names {
        let given = hosts.iter().map(|host| (*host).to_owned()).collect();
        let hosts = vec!["localhost".to_owned()];
        Names { port: 4747, is_secure: !is_loopback, is_loopback, hosts, given }
    }

    fn check(names: &Names, hosts: &str, expected: &Expect) {
        let line =
            |host: &str| format!("{host} {}\n", if names.answers_to(host) { "yes" } else { "no" });
        expected.assert_eq(&hosts.split_whitespace().map(line).collect::<String>());
    }

    #[test]
    fn on_the_loopback_only_its_own_names_count() {
        check(
            &names(true, &[]),
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
            &names(false, &["rover.lan"]),
            "rover.lan:4747 rover.lan ROVER.LAN:8443 192.168.0.7 192.168.0.7:4747 [fe80::1]:4747 evil.example:4747",
            &expect![[r"
                rover.lan:4747 yes
                rover.lan yes
                ROVER.LAN:8443 yes
                192.168.0.7 no
                192.168.0.7:4747 yes
                [fe80::1]:4747 yes
                evil.example:4747 no
            "]],
        );
    }

    #[test]
    fn a_page_is_ones_own_by_scheme_name_and_port() {
        let own = |origin, host| names(true, &[]).is_own(origin, &outer(None, host));
        assert!(own("http://localhost:4747", "localhost:4747"));
        assert!(!own("https://localhost:4747", "localhost:4747"));
        assert!(!own("http://localhost:3000", "localhost:4747"));
        assert!(!own("http://127.0.0.1:4747", "localhost:4747"));
        assert!(!own("null", "localhost:4747"));
    }

    fn outer(is_secure: Option<bool>, host: &str) -> OuterAddress {
        let peer = Peer { ip: "127.0.0.1".parse().unwrap(), is_near: true };
        let (host, base) = (host.to_owned(), BasePath::default());
        OuterAddress { is_secure, host, base, is_bare: false, peer }
    }

    #[test]
    fn behind_a_proxy_a_page_is_ones_own_by_the_address_that_the_browser_has() {
        let names = names(true, &["robot.lan"]);
        let own = |is_secure, origin, host| names.is_own(origin, &outer(is_secure, host));
        for is_secure in [None, Some(true)] {
            assert!(own(is_secure, "https://robot.lan", "robot.lan"));
            assert!(own(is_secure, "https://robot.lan", "robot.lan:443"));
            assert!(own(is_secure, "https://robot.lan:8443", "robot.lan:8443"));
            assert!(!own(is_secure, "https://robot.lan", "robot.lan:8443"));
            assert!(!own(is_secure, "https://evil.example", "robot.lan"));
        }
        assert!(own(None, "http://robot.lan", "robot.lan"));
        assert!(!own(Some(true), "http://robot.lan", "robot.lan"));
        assert!(!own(Some(false), "https://robot.lan", "robot.lan"));
    }
}
