//! The words that the proxy is started with.

use rafcon_testkit::link_world::Conditions;
use std::net::SocketAddr;
use std::path::PathBuf;

pub(crate) const USAGE: &str = "\
usage: link_proxy [--listen ADDRESS:PORT] [--to ADDRESS:PORT] [--tcp] | --tun [NAME]
  --tcp             carry connections of TCP instead of datagrams
  --tun NAME        be a network of two hosts instead: the namespaces NAME-robot and NAME-station (needs root)
  --page ADDRESS    show a page there that changes the link
  --at URL          the station's page, to which that page leads
  --record FILE     keep every datagram
  --delay MS --down BITS --up BITS --lost PERCENT --doubled PERCENT --late PERCENT --flipped PERCENT
on standard input: the same words without dashes, `cut`, `hold` or `mend` (one way with `down` or `up`), `say`, `replay FILE`,
`noise COUNT`, `end`";

/// What the proxy is to do.
pub(crate) struct Options {
    pub(crate) listen: SocketAddr,
    pub(crate) to: SocketAddr,
    /// The name of a network of two hosts, which is made instead of carrying datagrams on loopback.
    pub(crate) tun: Option<String>,
    /// Whether connections of TCP are carried.
    pub(crate) tcp: bool,
    pub(crate) page: Option<SocketAddr>,
    pub(crate) station_page: Option<String>,
    pub(crate) record: Option<PathBuf>,
    pub(crate) down: Conditions,
    pub(crate) up: Conditions,
    /// Words that change the path before anything is carried.
    pub(crate) changes: Vec<String>,
}

impl Options {
    /// What the words say, or which of them is wrong.
    pub(crate) fn read(words: impl Iterator<Item = String>) -> Result<Self, String> {
        let local = |port| SocketAddr::from(([127, 0, 0, 1], port));
        let mut found = Self {
            listen: local(4_750),
            to: local(4_748),
            tun: None,
            tcp: false,
            page: None,
            station_page: None,
            record: None,
            down: Conditions::delay_2s(256_000),
            up: Conditions::delay_2s(32_000),
            changes: Vec::new(),
        };
        let mut words = words.peekable();
        while let Some(word) = words.next() {
            if word == "--tun" {
                let name = words.next_if(|next| !next.starts_with('-'));
                found.tun = Some(name.unwrap_or_else(|| "rafcon".to_owned()));
                continue;
            }
            if word == "--tcp" {
                found.tcp = true;
                continue;
            }
            let value = words.next().ok_or_else(|| format!("`{word}` needs a value"))?;
            let address = || {
                value
                    .parse()
                    .map_err(|_none| format!("`{value}` is no address such as 127.0.0.1:4750"))
            };
            match word.strip_prefix("--") {
                Some("listen") => found.listen = address()?,
                Some("to") => found.to = address()?,
                Some("page") => found.page = Some(address()?),
                Some("at") => found.station_page = Some(value),
                Some("record") => found.record = Some(value.into()),
                // `--delay-ms` is what it was called once.
                Some("delay-ms") => found.changes.push(format!("delay {value}")),
                Some(name) => found.changes.push(format!("{name} {value}")),
                None => return Err(format!("`{word}` is not understood")),
            }
        }
        Ok(found)
    }
}
