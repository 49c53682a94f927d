//! A robot and a station as their users have them: two servers, a real network, and a path between them that damages what it carries.

use crate::harness::{Place, Run, ticks};
use crate::served::Door;
use expect_test::expect;
use rafcon_storage::journal::{Pack, writer_of};
use rafcon_supervisor::clock;
use rustix::process::{Pid, Signal, kill_process};
use serde_json::{Value, json};
use std::io::{BufRead as _, BufReader, Write as _};
use std::net::{SocketAddr, UdpSocket};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;

/// A server that is killed when it is dropped.
pub(crate) struct Program {
    child: Child,
    /// Its address for the command line.
    pub(crate) url: String,
    pub(crate) door: Door,
}

impl Program {
    pub(crate) fn new(mut child: Child) -> Self {
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let (url, token) = line.trim().split_once("/?token=").unwrap();
        let address = url.strip_prefix("http://").unwrap().parse().unwrap();
        let door = Door { address, token: token.to_owned() };
        Self { url: url.to_owned(), child, door }
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        self.child.kill().unwrap_or_default();
        self.child.wait().unwrap();
    }
}

pub(crate) fn pair(place: &Place, name: &str) {
    pair_with(place, name, "ground");
}

/// Makes a pairing at the robot, with these words, and pastes it at the station with this state.
pub(crate) fn pair_with(place: &Place, words: &str, station: &str) {
    pair_of(place, "robot", words, station);
}

/// The same at the robot with this state.
pub(crate) fn pair_of(place: &Place, state: &str, words: &str, station: &str) {
    let made = place.call(&format!("pair {words} --state {state}"));
    assert_eq!(made.code, Some(0), "{}", made.stderr);
    let mut paste = place.command(&format!("pair --paste --state {station}"));
    let mut paste = paste.stdin(Stdio::piped()).stdout(Stdio::null()).spawn().unwrap();
    // A terminal stays open after the line.
    let mut terminal = paste.stdin.take().unwrap();
    terminal.write_all(made.stdout.as_bytes()).unwrap();
    assert!(paste.wait().unwrap().success());
    drop(terminal);
}

/// A station that receives at this address, and where that is.
pub(crate) fn station(place: &Place, listen: &str) -> (Program, SocketAddr) {
    station_of(place, "ground", listen)
}

/// The same over a link of this profile.
pub(crate) fn station_over(place: &Place, listen: &str, link: &str) -> (Program, SocketAddr) {
    let (station, address, _) =
        begin_station(place.command(&station_words("ground", listen, link)));
    (station, address)
}

/// The same with this state, and runs beside it.
pub(crate) fn station_of(place: &Place, state: &str, listen: &str) -> (Program, SocketAddr) {
    let (station, address, _) = station_with_certificate(place, state, listen);
    (station, address)
}

/// The same with the fingerprint of its certificate.
pub(crate) fn station_with_certificate(
    place: &Place,
    state: &str,
    listen: &str,
) -> (Program, SocketAddr, String) {
    begin_station(place.command(&station_words(state, listen, "lan")))
}

fn station_words(state: &str, listen: &str, link: &str) -> String {
    format!(
        "station --state {state} --runs {state}-runs --bind 127.0.0.1:0 --listen {listen} --link {link}"
    )
}

/// Begins this station; answers where it receives, and the fingerprint of its certificate.
pub(crate) fn begin_station(mut station: Command) -> (Program, SocketAddr, String) {
    let mut child = station.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map(Result::unwrap);
    let said = lines.find_map(|line| Some(line.split_once("udp://")?.1.to_owned()));
    let address = said.unwrap().parse().unwrap();
    let certificate = lines.next().unwrap().rsplit_once(' ').unwrap().1.to_owned();
    // Whoever writes to it later is read.
    in_background(move || lines.for_each(drop));
    (Program::new(child), address, certificate)
}

pub(crate) fn robot(place: &Place, station: SocketAddr) -> Program {
    robot_over(place, station, "lan")
}

/// The same over a link of this profile.
pub(crate) fn robot_over(place: &Place, station: SocketAddr, link: &str) -> Program {
    begin_robot(place, "robot", &format!("--station udp://{station}"), link)
}

pub(crate) fn robot_with(place: &Place, stations: &str) -> Program {
    begin_robot(place, "robot", stations, "lan")
}

/// A robot with this state, and its runs beside it.
pub(crate) fn robot_of(place: &Place, state: &str, station: SocketAddr) -> Program {
    begin_robot(place, state, &format!("--station udp://{station}"), "lan")
}

fn begin_robot(place: &Place, state: &str, stations: &str, link: &str) -> Program {
    let words = format!(
        "serve --state {state} --runs {state}-runs --bind 127.0.0.1:0 --link {link} {stations}"
    );
    let mut robot = place.command(&words);
    Program::new(robot.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap())
}

pub(crate) fn in_background(work: impl FnOnce() + Send + 'static) {
    thread::Builder::new().spawn(work).unwrap();
}

/// A path that loses, doubles and damages datagrams in both directions, until dropped. It says where it begins, and knows all that
/// was sent.
pub(crate) struct BadPath {
    pub(crate) address: SocketAddr,
    station: SocketAddr,
    near: UdpSocket,
    far: UdpSocket,
    known: Arc<Mutex<Known>>,
    ends: Arc<AtomicBool>,
    is_down_cut: Arc<AtomicBool>,
    is_up_cut: Arc<AtomicBool>,
}

/// What passed a path.
#[derive(Default)]
struct Known {
    robot: Option<SocketAddr>,
    from_robot: Vec<Vec<u8>>,
    from_station: Vec<Vec<u8>>,
}

impl BadPath {
    pub(crate) fn to(station: SocketAddr) -> Self {
        let [near, far] = [(); 2].map(|()| UdpSocket::bind("127.0.0.1:0").unwrap());
        let (known, ends) = (Arc::<Mutex<Known>>::default(), Arc::new(AtomicBool::new(false)));
        let both = || (near.try_clone().unwrap(), far.try_clone().unwrap());
        let (down, up) = ((both(), Arc::clone(&known)), (both(), Arc::clone(&known)));
        let (first, second) = (Arc::clone(&ends), Arc::clone(&ends));
        let [is_down_cut, is_up_cut] = [(); 2].map(|()| Arc::new(AtomicBool::new(false)));
        let (is_cut, is_back_cut) = (Arc::clone(&is_down_cut), Arc::clone(&is_up_cut));
        in_background(move || {
            let ((near, far), known) = down;
            carry(&near, &first, |from, datagram| {
                let mut known = known.lock().unwrap();
                known.robot = Some(from);
                known.from_robot.push(datagram.to_vec());
                if is_cut.load(Ordering::Acquire) {
                    return;
                }
                far.send_to(datagram, station).unwrap_or_default();
            });
        });
        in_background(move || {
            let ((near, far), known) = up;
            carry(&far, &second, |_, datagram| {
                let mut known = known.lock().unwrap();
                known.from_station.push(datagram.to_vec());
                if is_back_cut.load(Ordering::Acquire) {
                    return;
                }
                if let Some(robot) = known.robot {
                    near.send_to(datagram, robot).unwrap_or_default();
                }
            });
        });
        let address = near.local_addr().unwrap();
        Self { address, station, near, far, known, ends, is_down_cut, is_up_cut }
    }

    /// Sends all that passed so far once more to whom it was sent, as someone does who has recorded it; answers how much it is.
    fn replay(&self) -> usize {
        let known = self.known.lock().unwrap();
        for datagram in &known.from_robot {
            self.far.send_to(datagram, self.station).unwrap();
        }
        for datagram in &known.from_station {
            self.near.send_to(datagram, known.robot.unwrap()).unwrap();
        }
        known.from_robot.len() + known.from_station.len()
    }

    /// Carries nothing from the robot while it is cut.
    fn cut_down(&self, is_cut: bool) {
        self.is_down_cut.store(is_cut, Ordering::Release);
    }

    /// Carries nothing from the station from now on.
    pub(crate) fn cut_up(&self) {
        self.is_up_cut.store(true, Ordering::Release);
    }

    /// Where the robot receives.
    fn robot(&self) -> SocketAddr {
        self.known.lock().unwrap().robot.unwrap()
    }
}

impl Drop for BadPath {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::Release);
    }
}

fn carry(socket: &UdpSocket, ends: &AtomicBool, mut send: impl FnMut(SocketAddr, &[u8])) {
    let mut buffer = [0; 2_000];
    for count in 1_usize.. {
        let Ok((length, from)) = socket.recv_from(&mut buffer) else { return };
        if ends.load(Ordering::Acquire) {
            return;
        }
        let datagram = &mut buffer[..length];
        if count.is_multiple_of(11) {
            datagram[count % length] ^= 1 << (count % 8);
        }
        if !count.is_multiple_of(7) {
            send(from, datagram);
        }
        if count.is_multiple_of(5) {
            send(from, datagram);
        }
    }
}

/// What strangers send: whatever bytes, as fast as they can.
pub(crate) fn make_noise(victim: SocketAddr) {
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    for count in 0..50_000_u32 {
        let [a, b, c, d] = count.to_be_bytes();
        // The first two say that it is a datagram of this protocol, whatever key it claims.
        let noise = [[1, d, c, b, a].as_slice(), &[d; 90]].concat();
        socket.send_to(&noise, victim).unwrap_or_default();
    }
}

/// All events of the newest run in a folder, with their values.
pub(crate) fn history(place: &Place, runs: &str) -> String {
    place.call(&format!("history last --json --values --runs {runs}")).stdout
}

/// The machines that the only run in a folder has kept.
pub(crate) fn machines(place: &Place, runs: &str) -> Vec<Pack> {
    let run = std::fs::read_dir(place.path(runs)).unwrap().next().unwrap().unwrap();
    let machines = Pack::read_after(&run.path(), 0).unwrap();
    assert!(!machines.is_empty());
    machines
}

/// Waits until the newest run at the station says this of itself.
pub(crate) fn wait_at_station(place: &Place, words: &str) {
    wait_at(place, "ground", words);
}

pub(crate) fn wait_at(place: &Place, station: &str, words: &str) {
    while !place.call(&format!("runs --runs {station}-runs")).stdout.contains(words) {
        thread::yield_now();
    }
}

/// Waits until a station knows that control of the newest run is like this: before that, its users decide under an old epoch.
pub(crate) fn wait_for_control(place: &Place, state: &str, url: &str, words: &str) {
    let show = format!("control last show --server {url} --state {state}");
    while !place.call(&show).stdout.contains(words) {
        thread::yield_now();
    }
}

#[test]
fn a_station_has_the_run_of_its_robot_although_the_path_is_bad_and_both_servers_die() {
    let place = Place::with(&ticks(3_000));
    pair(&place, "scout");
    let (ground, address) = station(&place, "127.0.0.1:0");
    let path = BadPath::to(address);
    let first = robot(&place, path.address);
    let run = Run::start(&place, "--runs robot-runs");
    wait_at_station(&place, "Ticks  running");
    drop(ground);
    wait_at_station(&place, ", not received by a station now");
    let resumed = place.call("resume last --runs ground-runs");
    expect!["error: this is the replica of a run of robot `scout`: resume it there, or name the server of this station with `--server`"]
        .assert_eq(resumed.stderr.lines().last().unwrap());
    drop(first);
    assert_eq!(run.end().0, Some(0));
    let (_ground, _) = station(&place, &address.to_string());
    let _second = robot(&place, path.address);
    wait_at_station(&place, "Ticks  ended with success");
    assert_eq!(history(&place, "ground-runs"), history(&place, "robot-runs"));
    assert_eq!(machines(&place, "ground-runs"), machines(&place, "robot-runs"));
}

#[test]
fn commands_at_a_station_reach_the_robot() {
    let place = Place::with(&ticks(1_000_000));
    pair(&place, "scout");
    let (_ground, address) = station(&place, "127.0.0.1:0");
    let path = BadPath::to(address);
    let _robot = robot(&place, path.address);
    let run = Run::start(&place, "--runs robot-runs");
    wait_at_station(&place, "Ticks  running");
    let robots_port = path.robot();
    in_background(move || make_noise(address));
    in_background(move || make_noise(robots_port));
    let tell = |command: &str| {
        let told = place.call(&format!("tell last {command} --runs ground-runs"));
        (told.code, told.stdout)
    };
    assert_eq!(tell("pause"), (Some(0), "applied\n".to_owned()));
    assert_eq!(tell("resume"), (Some(0), "applied\n".to_owned()));
    assert_eq!(tell("stop"), (Some(0), "applied\n".to_owned()));
    drop(run.end());
    wait_at_station(&place, "Ticks  ended with");
    assert_eq!(history(&place, "ground-runs"), history(&place, "robot-runs"));
}

/// Lines that no compression shortens by much.
fn long_script(lines: u64) -> String {
    let mut number = 1_u64;
    let noise = (0..lines).map(|_| {
        number = number.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963);
        format!("# {number:016x}\n")
    });
    noise
        .chain(["def execute(self, inputs, outputs, gvm):\n    return \"enough\"\n".into()])
        .collect()
}

#[test]
fn a_script_of_many_datagrams_crosses_a_slow_link() {
    let place = Place::with(&ticks(1_000_000));
    pair_with(&place, "scout --rights change", "ground");
    let (_ground, address, _) =
        begin_station(place.command(&station_words("ground", "127.0.0.1:0", "delay-2s")));
    let _robot = robot_over(&place, address, "delay-2s");
    let run = Run::start(&place, "--runs robot-runs");
    wait_at_station(&place, "Ticks  running");
    let script = long_script(300);
    let mut tell = place.command("tell last edit_script path=ROOT/TICKXX --runs ground-runs");
    let told = tell.arg(format!("script={script}")).output().unwrap();
    assert_eq!(String::from_utf8_lossy(&told.stdout), "applied\n", "{told:?}");
    // The new script ends the machine.
    drop(run.end());
    wait_at_station(&place, "Ticks  ended with");
    let journal = history(&place, "robot-runs");
    assert!(journal.contains(&serde_json::to_string(&script).unwrap()));
    assert_eq!(history(&place, "ground-runs"), journal);
}

#[test]
fn a_session_that_was_recorded_and_is_sent_again_changes_nothing() {
    let place = Place::with(&ticks(1_000_000));
    pair(&place, "scout");
    let (_ground, address) = station(&place, "127.0.0.1:0");
    let path = BadPath::to(address);
    let _robot = robot(&place, path.address);
    let run = Run::start(&place, "--runs robot-runs");
    wait_at_station(&place, "Ticks  running");
    let tell = |command: &str| {
        let told = place.call(&format!("tell last {command} --runs ground-runs"));
        assert_eq!((told.code, told.stdout.as_str()), (Some(0), "applied\n"), "{}", told.stderr);
    };
    ["pause", "step-mode", "resume"].into_iter().for_each(tell);
    assert!(path.replay() > 20, "too little was recorded");
    // What comes now is heeded after what was sent again.
    ["pause", "stop"].into_iter().for_each(tell);
    drop(run.end());
    wait_at_station(&place, "Ticks  ended with");
    let robots = history(&place, "robot-runs");
    // The five, and who is in control.
    assert_eq!(robots.matches("\"commanded\"").count(), 6);
    assert_eq!(history(&place, "ground-runs"), robots);
}

#[test]
fn one_user_commands_a_run_over_its_robot_and_its_station() {
    let place = Place::with(&ticks(1_000_000));
    pair(&place, "scout");
    let (ground, address) = station(&place, "127.0.0.1:0");
    let robot = robot(&place, address);
    let run = Run::start(&place, "--runs robot-runs");
    wait_at_station(&place, "Ticks  running");
    let at_station = |command: &str| {
        let told = place.call(&format!("tell last {command} --runs ground-runs"));
        format!("{}{}", told.stdout, told.stderr)
    };
    let at_robot = |wanted: &str| {
        let asked =
            place.call(&format!("control last {wanted} --server {} --state robot", robot.url));
        format!("{}{}", asked.stdout, asked.stderr)
    };
    let user = at_station("step-mode");
    let mut said = vec![user, at_robot("show"), at_robot("take-over"), at_robot("override")];
    wait_for_control(&place, "ground", &ground.url, "owner@robot is in control");
    said.extend([at_station("resume"), at_station("pause"), at_robot("release")]);
    wait_for_control(&place, "ground", &ground.url, "no user");
    said.push(at_station("resume"));
    said.push(at_station("stop"));
    drop(run.end());
    let said = said.concat();
    let firsts = said.lines().map(|line| line.split([',', ':']).take(2).collect::<Vec<_>>());
    let words = firsts.map(|parts| match parts[..] {
        [first @ ("error" | "refused"), second] => {
            format!("{first}:{}\n", second.split(" was active").next().unwrap())
        }
        _ => format!("{}\n", parts[0]),
    });
    expect![[r"
        applied
        owner@station is in control
        error: owner@station
        owner is in control
        refused: owner holds control of this run
        applied
        no user is in control; the first user to give a command gets control
        applied
        applied
    "]]
    .assert_eq(&words.collect::<String>());
}

#[test]
fn a_stop_that_the_robot_does_not_answer_ends_no_program_at_the_station() {
    let place = Place::with(&ticks(1_000_000));
    pair(&place, "scout");
    let (ground, address) = station(&place, "127.0.0.1:0");
    let robot = robot(&place, address);
    let run = Run::start(&place, "--runs robot-runs");
    wait_at_station(&place, "Ticks  running");
    drop(robot);
    let at_station =
        |words: &str| place.call(&format!("{words} --server {} --state ground", ground.url)).stderr;
    expect![[r"
        it is not known whether the command was carried out: the robot has not answered yet; the station repeats the request until it expires: send it again with its id
    "]]
    .assert_eq(&at_station("tell last stop"));
    assert_eq!(at_station("control last show"), "");
    drop(place.call("tell last stop --runs robot-runs"));
    drop(run.end());
}

/// The way back is cut: the robot pauses, and the station says that it does not know. Asked again once the robot is heard, it knows.
#[test]
fn a_command_whose_answer_is_lost_is_unknown_and_never_expired() {
    let place = Place::with(&ticks(1_000_000));
    pair(&place, "scout");
    let (ground, address) = station(&place, "127.0.0.1:0");
    let path = BadPath::to(address);
    let _robot = robot(&place, path.address);
    let run = Run::start(&place, "--runs robot-runs");
    wait_at_station(&place, "Ticks  running");
    while !place.call("link --state ground").stdout.contains("the round trip takes") {
        thread::yield_now();
    }
    path.cut_down(true);
    let expiry = clock::since_1970_ms() + 1_500;
    let pause =
        json!({ "id": "1", "author": "", "command": { "type": "pause" }, "expiry": expiry });
    let replica = std::fs::read_dir(place.path("ground-runs")).unwrap().next().unwrap().unwrap();
    let id = replica.file_name().into_string().unwrap();
    let ask = || {
        let path = format!("/api/v1/runs/{id}/commands");
        ground.door.ask("POST", &path, Some(&pause)).unwrap()["answer"].as_str().unwrap().to_owned()
    };
    let mut answers = vec![ask()];
    assert!(history(&place, "robot-runs").contains(r#""type":"pause""#), "it is carried out");
    answers.push(ask());
    path.cut_down(false);
    while ask() == "unknown" {
        thread::yield_now();
    }
    answers.push(ask());
    assert_eq!(answers, ["unknown", "unknown", "applied"]);
    drop(place.call("tell last stop --runs robot-runs"));
    drop(run.end());
}

#[test]
fn what_a_change_of_keys_left_behind_is_no_pairing() {
    let place = Place::empty();
    drop(place.call("pair scout --state robot"));
    let whole = std::fs::read_to_string(place.path("robot/link/pairings/scout")).unwrap();
    let stations = "--station udp://127.0.0.1:9 --station other=udp://127.0.0.1:9";
    for left in [&whole[..19], &whole] {
        std::fs::write(place.path("robot/link/pairings/scout.new"), left).unwrap();
        let served = place.call(&format!("serve --state robot --bind 127.0.0.1:0 {stations}"));
        expect![[r"
            error: this robot is not paired with a station `other`: run `rafcon pair NAME --station other` here, and `rafcon pair --paste` there
        "]]
        .assert_eq(&served.stderr);
    }
}

#[test]
fn a_station_does_on_the_robot_what_its_pairing_allows() {
    let mut said = Vec::new();
    for rights in ["observe", "command", "change"] {
        let place = Place::with(&ticks(1_000_000));
        let name = format!("ground-{rights}");
        pair_with(&place, &format!("scout --station {name} --rights {rights}"), &name);
        let (_ground, address) = station_of(&place, &name, "127.0.0.1:0");
        let robot = robot_with(&place, &format!("--station {name}=udp://{address}"));
        let run = Run::start(&place, "--runs robot-runs");
        wait_at(&place, &name, "Ticks  running");
        for command in ["pause", "reload", "stop"] {
            let told = place.call(&format!("tell last {command} --runs {name}-runs"));
            let first = format!("{}{}", told.stdout, told.stderr).lines().next().map(str::to_owned);
            said.push(format!("{rights} {command}: {}\n", first.unwrap_or_default()));
        }
        if rights == "observe" {
            assert_eq!(place.call("tell last stop --runs robot-runs").stdout, "applied\n");
        }
        drop(run.end());
        drop(robot);
    }
    expect![[r"
        observe pause: refused: the pairing of this station allows `observe`, and this needs `command`: pair again with `rafcon pair NAME --rights command` on the robot
        observe reload: refused: the pairing of this station allows `observe`, and this needs `change`: pair again with `rafcon pair NAME --rights change` on the robot
        observe stop: refused: the pairing of this station allows `observe`, and this needs `command`: pair again with `rafcon pair NAME --rights command` on the robot
        command pause: applied
        command reload: refused: the pairing of this station allows `command`, and this needs `change`: pair again with `rafcon pair NAME --rights change` on the robot
        command stop: applied
        change pause: applied
        change reload: applied
        change stop: applied
    "]]
    .assert_eq(&said.concat());
}

/// A state that runs until it is preempted.
const WAITS: &str = r#"
hierarchy ROOT "Waits"
  outcome success
  start -> WAITXX
  WAITXX.success -> .success
  execution WAITXX "Wait"
    outcome success
    script |
      def execute(self, inputs, outputs, gvm):
          self.preemptive_wait()
          return "success"
"#;

#[test]
fn a_run_whose_program_died_is_resumed_from_the_station() {
    let mut said = Vec::new();
    for rights in ["observe", "command"] {
        let place = Place::with(WAITS);
        pair_with(&place, &format!("scout --rights {rights}"), "ground");
        let (ground, address) = station(&place, "127.0.0.1:0");
        let robot = robot(&place, address);
        let run = Run::start(&place, "--runs robot-runs");
        wait_at_station(&place, "Waits  running");
        kill_process(run.runner().unwrap(), Signal::KILL).unwrap();
        drop(run.end());
        wait_at_station(&place, "Waits  crashed");
        let id = only_run(&place, "ground-runs");
        let resume = |request: &str| {
            let path = format!("/api/v1/runs/{id}/resume");
            let body = json!({ "id": request, "policy": "ask" });
            let (status, answer) = ground.door.answer("POST", &path, Some(&body)).unwrap();
            let answer: Value = serde_json::from_str(&answer).unwrap();
            format!("{rights}, request {request}: {status} {}\n", answer["message"])
        };
        said.push(resume("one"));
        if rights == "command" {
            wait_at_station(&place, "Waits  running");
            // An answer that was lost is asked for again; another request comes too late.
            said.extend([resume("one"), resume("two")]);
            kill_process(runner_of(&place), Signal::KILL).unwrap();
            wait_at_station(&place, "Waits  crashed");
            let url = &ground.url;
            let resumed = place.call(&format!("resume last --server {url} --state ground"));
            said.push(resumed.stderr);
            wait_at_station(&place, "Waits  running");
            assert_eq!(place.call("tell last stop --runs ground-runs").stdout, "applied\n");
            wait_at_station(&place, "Waits  ended with");
            assert_eq!(history(&place, "ground-runs"), history(&place, "robot-runs"));
            assert_eq!(history(&place, "robot-runs").matches("resumed").count(), 2);
        }
        drop(robot);
    }
    expect![[r#"
        observe, request one: 409 "scout: the pairing of this station allows `observe`, and this needs `command`: pair again with `rafcon pair NAME --rights command` on the robot"
        command, request one: 200 null
        command, request one: 200 null
        command, request two: 409 "scout: the run is active: command it instead"
        robot scout has resumed the run; follow it with `rafcon attach`
    "#]].assert_eq(&said.concat());
}

#[test]
fn a_robot_that_is_paired_while_the_station_runs_is_received_at_once() {
    let place = Place::with(&ticks(1_000_000));
    pair(&place, "scout");
    let (_ground, address) = station(&place, "127.0.0.1:0");
    pair_of(&place, "rover", "rover", "ground");
    let _rover = robot_of(&place, "rover", address);
    let run = Run::start(&place, "--runs rover-runs");
    wait_at_station(&place, "Ticks  running");
    drop(place.call("tell last stop --runs rover-runs"));
    drop(run.end());
}

/// The process that runs the only run of the robot.
fn runner_of(place: &Place) -> Pid {
    let folder = place.path("robot-runs").join(only_run(place, "robot-runs"));
    let process = writer_of(&folder).unwrap().unwrap();
    Pid::from_raw(i32::try_from(process).unwrap()).unwrap()
}

/// The id of the only run here.
fn only_run(place: &Place, runs: &str) -> String {
    let mut runs = std::fs::read_dir(place.path(runs)).unwrap();
    runs.next().unwrap().unwrap().file_name().into_string().unwrap()
}

/// How many runs at a server have this phase.
fn count_of(ground: &Program, phase: &str) -> usize {
    let (_status, runs) = ground.door.answer("GET", "/api/v1/runs", None).unwrap();
    runs.matches(&format!(r#""phase":"{phase}""#)).count()
}

/// Every restart races: the station opens its replicas while its server looks at their folders.
#[test]
fn a_station_that_is_killed_shows_every_run_of_its_robot_as_live_again() {
    const RUNS: usize = 4;
    let place = Place::with(&ticks(1_000_000));
    pair(&place, "scout");
    let (mut ground, address) = station(&place, "127.0.0.1:0");
    let _robot = robot(&place, address);
    let runs: Vec<Run> = (0..RUNS).map(|_| Run::start(&place, "--runs robot-runs")).collect();
    for _restart in 0..4 {
        while count_of(&ground, "live") < RUNS {
            thread::yield_now();
        }
        drop(ground);
        ground = station(&place, &address.to_string()).0;
    }
    for run in std::fs::read_dir(place.path("robot-runs")).unwrap() {
        let run = run.unwrap().file_name().into_string().unwrap();
        drop(place.call(&format!("tell {run} stop --runs robot-runs")));
    }
    for run in runs {
        drop(run.end());
    }
}

#[test]
fn what_is_not_paired_is_not_received() {
    let place = Place::empty();
    let station = place.call("station --state ground --listen 127.0.0.1:0 --bind 127.0.0.1:0");
    let robot = place.call("serve --state robot --station udp://127.0.0.1:9 --bind 127.0.0.1:0");
    let mut said = vec![station.stderr, robot.stderr];
    drop(place.call("pair scout --state robot"));
    let serve = "serve --state robot --bind 127.0.0.1:0";
    let one = "--station udp://127.0.0.1:9";
    said.extend(
        [
            "pair scout --state robot".to_owned(),
            "pair bad/name --state robot".to_owned(),
            "pair scout --station robot --state robot".to_owned(),
            format!("{serve} {one} {one}"),
            format!("{serve} {one} --station base=udp://127.0.0.1:9"),
        ]
        .map(|words| place.call(&words).stderr),
    );
    expect![[r"
        error: this station is paired with no robot: run `rafcon pair NAME` on the robot and `rafcon pair --paste` here
        error: this robot is not paired: run `rafcon pair NAME` here, and `rafcon pair --paste` at the station
        error: cannot write PLACE/robot/link/pairings/scout: to pair `scout` again, remove that file first
          because: File exists (os error 17)
        error: `bad/name` cannot name a robot: use 1 to 64 letters, digits, `.`, `-` and `_`; no station is called `robot`
        error: `scout` and `robot` cannot name a robot and a station: use 1 to 64 letters, digits, `.`, `-` and `_`; no station is called `robot`
        error: two stations would share the pairing of `scout`: make another one with `rafcon pair scout --station NAME`, and name it with `--station NAME=ADDRESS`
        error: this robot is not paired with a station `base`: run `rafcon pair NAME --station base` here, and `rafcon pair --paste` there
    "]].assert_eq(&said.concat());
}
