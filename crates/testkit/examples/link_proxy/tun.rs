//! A network of two hosts: two namespaces of the kernel with a TUN device each, whose packets pass through this program. What the
//! hosts send is real: TCP with its handshakes and back-off, UDP, pings.

use crate::ends::Devices;
use rustix::ioctl::{Setter, ioctl, opcode};
use std::ffi::c_int;
use std::fs::{File, OpenOptions};
use std::io;
use std::process::Command;
use std::sync::Arc;

/// The robot's address.
const ROBOT: &str = "10.48.0.1";
/// The station's address.
const STATION: &str = "10.48.0.2";
/// `TUNSETIFF` of `linux/if_tun.h`.
const SET_INTERFACE: u32 = opcode::write::<c_int>(b'T', 202);
/// `IFF_TUN | IFF_NO_PI`: IP packets without anything before them.
const PLAIN_TUN: u16 = 0x1001;
const NAME_MAX: usize = 15;

/// `struct ifreq` as far as it matters here.
#[repr(C)]
struct InterfaceRequest {
    name: [u8; NAME_MAX + 1],
    flags: u16,
    rest: [u8; 22],
}

/// The two hosts; gone when this is dropped.
pub(crate) struct Network {
    name: String,
    pub(crate) devices: Devices,
}

impl Network {
    pub(crate) fn make(name: &str) -> io::Result<Self> {
        let is_usable = |letter: char| letter.is_ascii_lowercase() || letter.is_ascii_digit();
        if name.is_empty() || name.len() + 2 > NAME_MAX || !name.chars().all(is_usable) {
            let why =
                format!("`{name}` cannot name a network: use 1 to 13 small letters and digits");
            return Err(io::Error::other(why));
        }
        let robot = device(&format!("{name}-r"))?;
        let station = device(&format!("{name}-s"))?;
        let devices = Devices { robot: Arc::new(robot), station: Arc::new(station) };
        let network = Self { name: name.to_owned(), devices };
        network.host("robot", "r", ROBOT, STATION)?;
        network.host("station", "s", STATION, ROBOT)?;
        Ok(network)
    }

    /// Gives a device to a host of its own, which reaches the other by it.
    fn host(&self, host: &str, end: &str, own: &str, other: &str) -> io::Result<()> {
        let (space, device) = (format!("{}-{host}", self.name), format!("{}-{end}", self.name));
        // One that a proxy has left that was killed.
        drop(Command::new("ip").args(["netns", "del", &space]).output());
        ip(&format!("netns add {space}"))?;
        ip(&format!("link set {device} netns {space}"))?;
        ip(&format!("-n {space} addr add {own} peer {other} dev {device}"))?;
        ip(&format!("-n {space} link set {device} mtu 1500 up"))?;
        ip(&format!("-n {space} link set lo up"))
    }

    /// How the hosts are used.
    pub(crate) fn greeting(&self) -> String {
        let name = &self.name;
        format!(
            "the robot is {ROBOT}:    ip netns exec {name}-robot bash\nthe station is {STATION}:  ip netns exec {name}-station bash"
        )
    }
}

impl Drop for Network {
    fn drop(&mut self) {
        for host in ["robot", "station"] {
            // Programs that still run there keep it, without a name.
            drop(ip(&format!("netns del {}-{host}", self.name)));
        }
    }
}

fn device(name: &str) -> io::Result<File> {
    let way_out = |error: io::Error| {
        io::Error::other(format!(
            "no network device can be made ({error}): a network of two hosts needs root and /dev/net/tun; without them leave out --tun, which carries datagrams on loopback"
        ))
    };
    let file = OpenOptions::new().read(true).write(true).open("/dev/net/tun").map_err(way_out)?;
    let mut request = InterfaceRequest { name: [0; NAME_MAX + 1], flags: PLAIN_TUN, rest: [0; 22] };
    for (place, letter) in request.name.iter_mut().zip(name.bytes().take(NAME_MAX)) {
        *place = letter;
    }
    attach(&file, request).map_err(way_out)?;
    Ok(file)
}

#[expect(unsafe_code, reason = "the kernel has no safe door to network devices")]
fn attach(file: &File, request: InterfaceRequest) -> io::Result<()> {
    // SAFETY: `TUNSETIFF` reads one `struct ifreq`, which is 40 bytes long, as `InterfaceRequest` is; it keeps no reference to it.
    let done = unsafe { ioctl(file, Setter::<SET_INTERFACE, InterfaceRequest>::new(request)) };
    done.map_err(io::Error::from)
}

fn ip(words: &str) -> io::Result<()> {
    let output = Command::new("ip").args(words.split(' ')).output();
    let output = output.map_err(|error| {
        io::Error::other(format!("`ip` of iproute2 is needed for a network of two hosts: {error}"))
    })?;
    if output.status.success() {
        return Ok(());
    }
    let said = String::from_utf8_lossy(&output.stderr);
    Err(io::Error::other(format!("`ip {words}` failed: {}", said.trim())))
}
