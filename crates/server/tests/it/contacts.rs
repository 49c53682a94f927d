//! The planned contacts with a robot: access, replacement and refusals.

use crate::harness::{Answer, TestServer};
use expect_test::{Expect, expect};
use rafcon_protocol::api::{
    ListRequest, RobotAnswer, RobotMachines, RobotRequest, Role, ValueFetch,
};
use rafcon_protocol::{CommandList, ContactPlan, ListLine, ListRelease, ListedCommand};
use rafcon_server::{CommandListFault, ContactsFault, MachinesFault, NotTaken, Robots, RunValue};
use serde_json::{Value, json};
use std::sync::{Arc, Mutex};

/// A station that receives only the robot `scout`, without data.
#[derive(Debug, Default)]
struct OneRobot {
    plan: Mutex<ContactPlan>,
    commands: Mutex<Vec<ListedCommand>>,
    /// The user who has released the list.
    released: Mutex<Option<String>>,
    is_disk_full: bool,
}

impl OneRobot {
    /// The list. Its revision is the number of its commands.
    fn list(&self) -> CommandList {
        let commands = self.commands.lock().unwrap();
        let line = |listed: &ListedCommand| ListLine {
            listed: listed.clone(),
            not_before_ms: None,
            expires_ms: None,
            send_at_ms: None,
            effect_ms: None,
            fault: None,
            fate: None,
        };
        let user = self.released.lock().unwrap().clone();
        CommandList {
            revision: commands.len().to_string(),
            released: user.map(|user| ListRelease { at_ms: 1, user }),
            lines: commands.iter().map(line).collect(),
        }
    }
}

impl Robots for OneRobot {
    fn fetch(&self, _: &str, _: RunValue<'_>, _: u64, _: u64) -> bool {
        false
    }

    fn cancel(&self, _: &str, _: RunValue<'_>) {}

    fn progress(&self, _: RunValue<'_>) -> Option<ValueFetch> {
        None
    }

    fn request(
        &self,
        _: &str,
        _: RobotRequest,
        _: Box<dyn FnOnce(RobotAnswer) + Send>,
    ) -> Result<(), NotTaken> {
        Err(NotTaken::Full("no room".to_owned()))
    }

    fn names(&self) -> Vec<String> {
        vec!["scout".to_owned()]
    }

    fn machines(&self, robot: &str) -> Result<RobotMachines, MachinesFault> {
        known(robot)
            .map_err(|_fault| MachinesFault::NotReceived("no such robot here".to_owned()))?;
        Err(MachinesFault::NotArrived("no list yet".to_owned()))
    }

    fn cost(&self, _: &str, _: u64) -> Option<(u64, Option<u64>)> {
        None
    }

    fn command_list(&self, robot: &str) -> Result<CommandList, CommandListFault> {
        known(robot)
            .map_err(|_fault| CommandListFault::NotReceived("no such robot here".to_owned()))?;
        Ok(self.list())
    }

    fn set_command_list(
        &self,
        robot: &str,
        commands: Vec<ListedCommand>,
        revision: Option<&str>,
    ) -> Result<CommandList, CommandListFault> {
        let list = self.command_list(robot)?;
        if revision.is_some_and(|revision| revision != list.revision) {
            return Err(CommandListFault::Changed("it was changed".to_owned()));
        }
        if self.is_disk_full {
            return Err(CommandListFault::Unavailable("the disk is full".to_owned()));
        }
        *self.commands.lock().unwrap() = commands;
        Ok(self.list())
    }

    fn release_command_list(
        &self,
        robot: &str,
        request: &ListRequest,
    ) -> Result<CommandList, CommandListFault> {
        self.command_list(robot)?;
        let faults = request.lines.iter().filter_map(|line| line.fault.clone());
        let faults: Vec<_> = faults.collect();
        if !faults.is_empty() {
            return Err(CommandListFault::Faulty(faults.join("\n")));
        }
        *self.released.lock().unwrap() = Some(request.user.clone());
        Ok(self.list())
    }

    fn contacts(&self, robot: &str) -> Result<ContactPlan, ContactsFault> {
        known(robot)?;
        Ok(self.plan.lock().unwrap().clone())
    }

    fn set_contacts(&self, robot: &str, plan: ContactPlan) -> Result<(), ContactsFault> {
        known(robot)?;
        if self.is_disk_full {
            return Err(ContactsFault::Storage("the disk is full".to_owned()));
        }
        *self.plan.lock().unwrap() = plan;
        Ok(())
    }
}

fn known(robot: &str) -> Result<(), ContactsFault> {
    let unknown = || ContactsFault::NotReceived("no such robot here".to_owned());
    (robot == "scout").then_some(()).ok_or_else(unknown)
}

pub(crate) fn station(is_disk_full: bool) -> TestServer {
    let robots = Arc::new(OneRobot { is_disk_full, ..OneRobot::default() });
    TestServer::with(|settings| settings.robots = Some(robots))
}

fn window(begin: &str, end: &str) -> Value {
    json!({ "begin": begin, "end": end, "profile": "deep" })
}

fn set(server: &TestServer, robot: &str, body: &Value) -> Answer {
    let path = format!("/api/v1/robots/{robot}/contacts");
    server.call(Some(Role::Operator), "PUT", &path, Some(body))
}

fn get(server: &TestServer, role: Role) -> Answer {
    server.call(Some(role), "GET", "/api/v1/robots/scout/contacts", None)
}

#[test]
fn operators_set_the_contacts_and_viewers_read_them() {
    let server = station(false);
    assert_eq!(get(&server, Role::Viewer).json(), json!([]));
    let plan = json!([
        window("2126-11-28T14:00:00Z", "2126-11-28T14:20:00Z"),
        window("2126-11-28T15:00:00Z", "2126-11-28T15:20:00Z"),
    ]);
    let answer = set(&server, "scout", &plan);
    assert_eq!((answer.status, answer.json()), (200, plan.clone()));
    assert_eq!(get(&server, Role::Viewer).json(), plan);
    let path = "/api/v1/robots/scout/contacts";
    let viewer = server.call(Some(Role::Viewer), "PUT", path, Some(&json!([])));
    assert_eq!(viewer.said(), "403 not_your_right");
    assert_eq!(get(&server, Role::Viewer).json(), plan);
    assert_eq!(set(&server, "scout", &json!([])).status, 200);
    assert_eq!(get(&server, Role::Viewer).json(), json!([]));
}

#[test]
fn a_list_that_is_no_plan_changes_nothing() {
    let server = station(false);
    let plan = json!([window("2126-11-28T14:00:00Z", "2126-11-28T14:20:00Z")]);
    assert_eq!(set(&server, "scout", &plan).status, 200);
    let check = |body: &Value, expect: &Expect| {
        let answer = set(&server, "scout", body);
        let message = answer.json()["message"].as_str().unwrap().to_owned();
        expect.assert_eq(&format!("{}: {message}", answer.said()));
        assert_eq!(get(&server, Role::Viewer).json(), plan);
    };
    check(
        &json!([
            window("2126-11-28T14:00:00Z", "2126-11-28T14:20:00Z"),
            window("2126-11-28T14:19:00Z", "2126-11-28T14:40:00Z"),
        ]),
        &expect![
            "400 bad_contacts: window 2 (2126-11-28T14:19:00Z to 2126-11-28T14:40:00Z): it overlaps window 1 (2126-11-28T14:00:00Z to 2126-11-28T14:20:00Z): let it begin at 2126-11-28T14:20:00Z or later, or make one window of both"
        ],
    );
    check(
        &json!([{ "begin": 1 }]),
        &expect![
            "400 bad_contacts: window 1: invalid type: integer `1`, expected a string; a window has begin, end, profile and, if you like, a note"
        ],
    );
    let past =
        set(&server, "scout", &json!([window("2020-01-01T00:00:00Z", "2020-01-02T00:00:00Z")]));
    let message = past.json()["message"].as_str().unwrap().to_owned();
    assert!(message.starts_with("window 1 (2020-01-01T00:00:00Z to 2020-01-02T00:00:00Z): this last window is in the past; "), "{message}");
    let windows: Vec<_> = (0..1_001)
        .map(|nth| format!("2126-11-28T14:00:00.{nth:03}Z"))
        .map(|time| window(&time, &time))
        .collect();
    check(
        &Value::Array(windows),
        &expect![
            "400 bad_contacts: the list has 1001 windows and the limit is 1000: remove the latest ones"
        ],
    );
}

#[test]
fn a_server_that_does_not_receive_the_robot_has_no_contacts_with_it() {
    let server = station(false);
    assert_eq!(set(&server, "mule", &json!([])).said(), "404 no_such_robot");
    let no_station = TestServer::new();
    assert_eq!(get(&no_station, Role::Viewer).said(), "404 no_such_robot");
    assert_eq!(set(&station(true), "scout", &json!([])).said(), "503 contacts_unavailable");
}

#[test]
fn viewers_see_the_robots_of_a_station_and_that_their_machines_are_unknown() {
    let see = |server: &TestServer, path: &str| {
        let answer = server.call(Some(Role::Viewer), "GET", &format!("/api/v1/robots{path}"), None);
        if answer.status == 200 { answer.json().to_string() } else { answer.said() }
    };
    let (ground, no_station) = (station(false), TestServer::new());
    assert_eq!(see(&ground, ""), r#"["scout"]"#);
    assert_eq!(see(&no_station, ""), "[]");
    assert_eq!(see(&ground, "/scout/machines"), "503 machines_unknown");
    assert_eq!(see(&ground, "/mule/machines"), "404 no_such_robot");
    assert_eq!(see(&no_station, "/scout/machines"), "404 no_such_robot");
}
