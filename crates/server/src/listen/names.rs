//! Host names of the server, derived from its address and settings.

use super::tls;
use crate::access::Names;
use crate::settings::Listen;
use std::net::SocketAddr;

/// All host names that the server accepts.
pub(super) fn of(listen: &Listen, address: SocketAddr) -> Names {
    let is_loopback = address.ip().is_loopback();
    let given = listen.hosts.iter().map(|host| host.to_ascii_lowercase()).collect();
    let mut hosts = vec!["localhost".to_owned()];
    if !is_loopback {
        hosts.extend(host_name());
    }
    let is_secure = tls::is_needed(listen, address);
    Names { port: address.port(), is_secure, is_loopback, hosts, given }
}

/// Host name of this computer.
fn host_name() -> Option<String> {
    let uname = rustix::system::uname();
    let name = uname.nodename().to_str().ok()?.to_ascii_lowercase();
    (!name.is_empty()).then_some(name)
}
