//! A robot whose disk hangs.

use super::*;
use crate::carrier::StationAddress;
use crate::pairing::Pairing;
use crate::requests::Answered;
use rafcon_link::{Identity, SenderStart, StationSession};
use rafcon_protocol::Command;
use rafcon_protocol::api::{Control, ControlMove, ResumeRequest, Right, StartRequest};
use std::fs::OpenOptions;
use std::net::UdpSocket;
use std::thread;

/// Nobody commands these runs.
#[derive(Debug)]
struct Nobody;

impl Authority for Nobody {
    fn command(&self, _: &str, _: &str, _: &str, _: u64) -> Result<(), String> {
        Err("nobody commands".to_owned())
    }

    fn refused(&self, _: &str, _: &str) {}

    fn right_of(&self, _: &Command) -> Right {
        Right::Command
    }

    fn move_control(&self, _: &str, _: &str, _: &ControlMove) -> Result<(), String> {
        Err("nobody commands".to_owned())
    }

    fn is_ready(&self) -> bool {
        true
    }

    fn resume(&self, _: ResumeRequest, _: Answered) -> Result<(), String> {
        Err("nobody resumes".to_owned())
    }

    fn fate_of_resume(&self, _: &str, _: &str, _: &str) -> RobotAnswer {
        RobotAnswer::Expired
    }

    fn start(&self, _: StartRequest, _: Answered) -> Result<(), String> {
        Err("nobody starts".to_owned())
    }

    fn fate_of_start(&self, _: &str, _: &str) -> RobotAnswer {
        RobotAnswer::Expired
    }

    fn present(&self, _: &str) {}

    fn control(&self, _: &str) -> Option<Control> {
        None
    }
}

#[test]
fn datagrams_pass_while_the_folder_of_a_run_cannot_be_read() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    let run = folder.join("runs/20260101-0000-drive-0001");
    fs::create_dir_all(&run).unwrap();
    fs::write(run.join("run.json"), "{}").unwrap();
    // A pipe: the thread that tests the lock waits until a writer opens it.
    let lock = run.join("lock");
    let mode = rustix::fs::Mode::RUSR | rustix::fs::Mode::WUSR;
    rustix::fs::mknodat(rustix::fs::CWD, &lock, rustix::fs::FileType::Fifo, mode, 0).unwrap();
    let pairing = Pairing::generate("scout", None).unwrap();
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    let (file, next) = (folder.join("pairing"), folder.join("next"));
    let settings = RobotSettings {
        folder: folder.join("link"),
        runs: folder.join("runs"),
        projects: Projects::default(),
        paired: Paired { pairing: pairing.clone(), file, next },
        station: StationAddress::Udp(socket.local_addr().unwrap()),
        profile: Profile::LAN,
        authority: Arc::new(Nobody),
        tell: |_| {},
    };
    let stopper = Stopper::default();
    let theirs = stopper.clone();
    let robot = thread::Builder::new().spawn(move || relay_robot(&settings, &theirs).unwrap());
    let identity = Identity {
        key_id: pairing.key_id,
        key: &pairing.key,
        robot: &pairing.robot,
        start: SenderStart::new(1, 0),
        heard: None,
    };
    let (mut station, clock) =
        (StationSession::new(&identity, Profile::LAN), SessionClock::begin());
    // Two scans are due after two seconds of the robot's clock.
    while station.robot_clock(clock.now()).is_none_or(|clock| clock.earliest_ms < 2_500) {
        let mut datagram = vec![0; 65_535];
        let length = socket.recv(&mut datagram).unwrap();
        station.handle_datagram(clock.now(), &mut datagram[..length], |_| {}).unwrap();
    }
    stopper.stop();
    // Releases the thread, so that the robot ends.
    drop(OpenOptions::new().write(true).open(lock).unwrap());
    robot.unwrap().join().unwrap();
}
