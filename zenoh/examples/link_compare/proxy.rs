//! A link proxy of the project as a program beside this one.

use anyhow::{Context as _, Result, bail};
use serde_json::Value;
use std::io::{BufRead as _, BufReader, Write as _};
use std::net::SocketAddr;
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};

/// What a proxy carries.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Carries {
    Datagrams,
    /// Connections of TCP.
    Connections,
}

/// A proxy that ends with this.
#[derive(Debug)]
pub(crate) struct Proxy {
    child: Child,
    says: BufReader<ChildStdout>,
    /// Where robots send to.
    pub(crate) address: SocketAddr,
}

impl Proxy {
    /// Starts a proxy that carries to this address.
    pub(crate) fn start(program: &Path, carries: Carries, to: SocketAddr) -> Result<Self> {
        let mut command = Command::new(program);
        command.args(["--listen", "127.0.0.1:0", "--to", &to.to_string()]);
        if carries == Carries::Connections {
            command.arg("--tcp");
        }
        command.stdin(Stdio::piped()).stdout(Stdio::piped());
        let child = command.spawn();
        let mut child = child.with_context(|| format!("cannot start {}", program.display()))?;
        let says = child.stdout.take().context("it has an output")?;
        let mut proxy = Self { child, says: BufReader::new(says), address: to };
        let line = proxy.line()?;
        let address = line.rsplit_once("://").context("it says where robots send to")?.1;
        proxy.address = address.trim().parse()?;
        Ok(proxy)
    }

    /// Tells it something; answers how it is then.
    pub(crate) fn say(&mut self, word: &str) -> Result<Value> {
        let input = self.child.stdin.as_mut().context("it has an input")?;
        writeln!(input, "{word}")?;
        let line = self.line()?;
        let said: Value = serde_json::from_str(&line).with_context(|| format!("it says {line}"))?;
        match said.get("error") {
            Some(error) => bail!("the proxy does not do it: {error}"),
            None => Ok(said),
        }
    }

    /// How many bytes the robot has sent.
    pub(crate) fn bytes(&mut self) -> Result<u64> {
        self.say("say")?["down"]["bytes"].as_u64().context("it does not count")
    }

    fn line(&mut self) -> Result<String> {
        let mut line = String::new();
        self.says.read_line(&mut line)?;
        Ok(line)
    }
}

impl Drop for Proxy {
    fn drop(&mut self) {
        drop(self.child.kill());
        drop(self.child.wait());
    }
}
