//! A station whose files cannot be read for a while.

use super::*;
use crate::inbox::Stopper;
use crate::machine_lists::MachineLists;
use crate::pairing::{Paired, Pairing};
use parking_lot::Mutex;
use rafcon_link::{EventBlock, Identity, RobotSession, RunSource, SenderStart, StreamId as Stream};
use rafcon_protocol::api::Right;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;

/// Pairings of a disk that hangs after the first read.
#[derive(Debug)]
struct HangingList {
    paired: Paired,
    is_read: Mutex<bool>,
    hangs: SyncSender<()>,
    released: Mutex<Receiver<()>>,
}

impl PairingList for HangingList {
    fn read(&self) -> Result<Vec<Paired>, String> {
        if std::mem::replace(&mut *self.is_read.lock(), true) {
            self.hangs.send(()).unwrap_or_default();
            // Until the test ends.
            let _ended = self.released.lock().recv();
        }
        Ok(vec![self.paired.clone()])
    }
}

struct NoRuns;

impl RunSource for NoRuns {
    fn events(&mut self, _: Stream, _: u64, _: u64, _: usize) -> Option<EventBlock> {
        None
    }

    fn snapshot(&mut self, _: Stream) -> Option<(u64, Vec<u8>)> {
        None
    }
}

#[test]
fn datagrams_pass_while_the_pairings_and_contacts_cannot_be_read() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    let pairing = Pairing::generate("scout", None).unwrap();
    let (file, next) = (folder.join("pairing"), folder.join("next"));
    let paired = Paired { pairing: pairing.clone(), file, next };
    let (hangs, is_hanging) = sync_channel(1);
    let (release, released) = sync_channel::<()>(0);
    let list = HangingList { paired, is_read: Mutex::new(false), hangs, released: released.into() };
    let settings = StationSettings {
        folder: folder.join("ground"),
        runs: folder.join("runs"),
        pairings: Arc::new(list),
        bind: ([127, 0, 0, 1], 0).into(),
        tls: None,
        profile: Profile::LAN,
        value_fetches: ValueFetchBroker::default(),
        server_requests: RequestBroker::default(),
        contacts: ContactStore::default(),
        lists: CommandListStore::new(|_| Right::Command),
        machines: MachineLists::default(),
        tell: |_| {},
    };
    let stopper = Stopper::default();
    let (up, is_up) = sync_channel(1);
    let station = {
        let stopper = stopper.clone();
        thread::Builder::new().spawn(move || {
            relay_station(&settings, &stopper, |address| up.send(address).unwrap()).unwrap();
        })
    };
    let address = is_up.recv().unwrap();
    is_hanging.recv().unwrap();
    let identity = Identity {
        key_id: pairing.key_id,
        key: &pairing.key,
        robot: &pairing.robot,
        start: SenderStart::new(1, 0),
        heard: None,
    };
    let (mut robot, clock) = (RobotSession::new(&identity, Profile::LAN), SessionClock::begin());
    robot.begin(Stream(1), 0);
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    socket.set_nonblocking(true).unwrap();
    // The station answers, although its disk hangs.
    while robot.heard_before(clock.now()).is_none() {
        while let Some(datagram) = robot.poll_transmit(clock.now(), &mut NoRuns).unwrap() {
            socket.send_to(&datagram, address).unwrap();
        }
        let mut datagram = vec![0; 65_535];
        if let Ok(length) = socket.recv(&mut datagram) {
            robot.handle_datagram(clock.now(), &mut datagram[..length], |_| {}).unwrap();
        }
        thread::yield_now();
    }
    drop(release);
    stopper.stop();
    station.unwrap().join().unwrap();
}
