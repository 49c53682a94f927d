//! Connections of TCP over the same path: robots connect to `--listen`, and their bytes go on to `--to`. Bytes come late and at the
//! rate, never lost or out of order: what would be lost stalls all behind it for a round trip, as TCP repairs it at best; a cut stalls
//! them, and nobody is told. How a kernel behaves on a lossy path only `--tun` shows.

use crate::ends::{Arrival, Arrives, Ends};
use std::collections::BTreeMap;
use std::io::{self, Read as _, Write as _};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex};
use std::thread;

/// So many bytes are carried as one.
const CHUNK: usize = 1_400;
/// So many chunks of a connection are on their way at once, as with a window of TCP.
const WINDOW: usize = 46;
/// Before the bytes of a chunk: the number of its connection.
const HEAD: usize = 4;
/// The headers of IP and TCP, without what stands before a chunk here.
pub(crate) const HEADERS: usize = 40 - HEAD;

/// A direction of a connection: where its chunks go when they arrive, and whose credit they return.
struct Way {
    out: SyncSender<Vec<u8>>,
    credit: SyncSender<()>,
}

type Ways = Arc<Mutex<BTreeMap<u32, Way>>>;

/// The connections.
#[derive(Clone)]
pub(crate) struct Connections {
    address: SocketAddr,
    to_station: Ways,
    to_robot: Ways,
}

impl Connections {
    pub(crate) fn open(
        listen: SocketAddr,
        station: SocketAddr,
        arrivals: &SyncSender<Arrival>,
    ) -> io::Result<Self> {
        let listener = TcpListener::bind(listen)?;
        let address = listener.local_addr()?;
        let connections = Self { address, to_station: Ways::default(), to_robot: Ways::default() };
        let (accepted, arrivals) = (connections.clone(), arrivals.clone());
        let accept = move || {
            for (number, robot) in (0_u32..).zip(listener.incoming().flatten()) {
                // A station that is not there takes no connection.
                drop(accepted.join(number, &robot, station, &arrivals));
            }
        };
        thread::Builder::new().spawn(accept)?;
        Ok(connections)
    }

    /// Where robots connect.
    pub(crate) fn address(&self) -> SocketAddr {
        self.address
    }

    /// Connects to the station, and carries the bytes of both.
    fn join(
        &self,
        number: u32,
        robot: &TcpStream,
        station: SocketAddr,
        arrivals: &SyncSender<Arrival>,
    ) -> io::Result<()> {
        let station = TcpStream::connect(station)?;
        let directions = [
            (robot, &station, &self.to_station, Arrival::FromRobot as Arrives),
            (&station, robot, &self.to_robot, Arrival::FromStation),
        ];
        for (from, to, ways, arrival) in directions {
            to.set_nodelay(true)?;
            let (out, chunks) = sync_channel(WINDOW);
            let (credit, credits) = sync_channel(WINDOW);
            if let Ok(mut ways) = ways.lock() {
                ways.insert(number, Way { out, credit });
            }
            let (from, to, arrivals) = (from.try_clone()?, to.try_clone()?, arrivals.clone());
            thread::Builder::new().spawn(move || {
                read(number, from, &credits, |it| arrivals.send(arrival(it)).is_ok());
            })?;
            thread::Builder::new().spawn(move || write(to, &chunks))?;
        }
        Ok(())
    }
}

impl Ends for Connections {
    fn to_robot(&self, chunk: &[u8]) {
        deliver(&self.to_robot, chunk);
    }

    fn to_station(&self, chunk: &[u8]) {
        deliver(&self.to_station, chunk);
    }
}

/// Reads while chunks find room on their way. An empty one says that no more will come.
fn read(number: u32, mut from: TcpStream, credits: &Receiver<()>, send: impl Fn(Vec<u8>) -> bool) {
    let mut on_their_way = 0;
    loop {
        let mut chunk = number.to_be_bytes().to_vec();
        chunk.resize(HEAD + CHUNK, 0);
        let length = from.read(&mut chunk[HEAD..]).unwrap_or(0);
        chunk.truncate(HEAD + length);
        if !send(chunk) || length == 0 {
            return;
        }
        on_their_way += 1;
        while on_their_way >= WINDOW {
            if credits.recv().is_err() {
                return;
            }
            on_their_way -= 1;
        }
        on_their_way -= credits.try_iter().count().min(on_their_way);
    }
}

fn write(mut to: TcpStream, chunks: &Receiver<Vec<u8>>) {
    for chunk in chunks {
        if chunk.is_empty() || to.write_all(&chunk).is_err() {
            break;
        }
    }
    to.shutdown(Shutdown::Write).unwrap_or_default();
}

fn deliver(ways: &Ways, chunk: &[u8]) {
    let Some((number, bytes)) = chunk.split_first_chunk() else { return };
    let (number, Ok(mut ways)) = (u32::from_be_bytes(*number), ways.lock()) else { return };
    let Some(way) = ways.get(&number) else { return };
    // As many wait at most as are on their way at once: there is room.
    let is_open = way.out.try_send(bytes.to_vec()).is_ok();
    way.credit.try_send(()).unwrap_or_default();
    if bytes.is_empty() || !is_open {
        ways.remove(&number);
    }
}
