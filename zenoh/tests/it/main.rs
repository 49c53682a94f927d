//! Robot, station, `rafcon-zenoh` on both sides, and Zenoh's own router: the real programs, as people start them.
//!
//! `cargo xtask zenoh` builds what they need and says where it lies.

mod harness;

use harness::{Certificates, Mission, Network, Stranger};

#[test]
fn a_station_has_the_run_over_mutual_tls_although_both_sides_begin_anew_within_the_lease() {
    let certificates = Certificates::new();
    let network = Network::with_tls(&certificates);
    let mission = Mission::new(&network);
    let (station, robot) = (mission.zenoh_station(), mission.zenoh_robot());
    mission.begin(robot.says());
    mission.wait_at_station("running");
    assert_eq!(mission.list(), "scout\n");
    // Killed, as by a power cut: no one hears a farewell.
    drop(robot);
    let robot = mission.zenoh_robot_at();
    drop(station);
    let station = mission.zenoh_station();
    mission.wait_at_station("ended with success");
    assert_eq!(mission.history("ground-runs"), mission.history("robot-runs"));
    drop((station, robot));
}

#[test]
fn a_stranger_without_a_certificate_is_not_let_in() {
    let certificates = Certificates::new();
    let network = Network::with_tls(&certificates);
    let mission = Mission::new(&network);
    let _robot = mission.zenoh_robot();
    mission.wait_listed();
    let others = Certificates::new();
    for trusted in [&others, &certificates] {
        assert!(mission.list_with(&network.config_with(trusted, &others)).is_empty());
    }
}

#[test]
fn a_stranger_sees_sealed_datagrams_and_neither_forges_nor_stops_them() {
    let network = Network::open();
    let mission = Mission::new(&network);
    let (_station, robot) = (mission.zenoh_station(), mission.zenoh_robot());
    let stranger = Stranger::at(&network);
    mission.begin(robot.says());
    mission.wait_at_station("running");
    assert_eq!(mission.tell("pause"), "applied\n");
    assert_eq!(mission.tell("resume"), "applied\n");
    mission.wait_at_station("ended with success");
    assert_eq!(mission.history("ground-runs"), mission.history("robot-runs"));
    let saw = stranger.end();
    assert_eq!(saw.readable, 0, "a payload is readable");
    assert!(saw.down > 10 && saw.up > 10 && saw.forged > 1_000, "{saw:?}");
}
