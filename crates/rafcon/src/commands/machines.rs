//! `rafcon machines`: the machines in the projects of a station's robot.

use super::kept::out;
use super::link::folder_of_robot;
use super::remote;
use super::serve::state;
use crate::cli::{self, ListFormat};
use crate::environment::Environment;
use crate::view::harmless;
use anyhow::{Result, bail};
use rafcon_protocol::api::{MachineFile, RobotMachines};
use rafcon_protocol::calendar::utc_text;
use rafcon_relay::{MachinesUnknown, read_machine_list};
use std::io::Write as _;
use std::process::ExitCode;

/// Prints the list that arrived last.
pub(super) fn machines(raw: &cli::Machines, environment: &Environment) -> Result<ExitCode> {
    let robot = &raw.robot;
    let list = if let Some(server) = remote::server(&raw.remote, environment)? {
        server.machines(robot)?
    } else {
        let state = state(&raw.remote.access.state, environment)?;
        match read_machine_list(&folder_of_robot(&state, robot)?)? {
            Some(list) => list,
            None => bail!("robot {robot}: {}", MachinesUnknown::NotArrived),
        }
    };
    let mut out = out();
    match raw.format {
        ListFormat::Json => writeln!(out, "{}", serde_json::to_string_pretty(&list)?)?,
        ListFormat::Text => write!(out, "{}", in_words(&list))?,
    }
    out.flush()?;
    Ok(ExitCode::SUCCESS)
}

/// The age of the list, then a line for each machine, as `rafcon run --robot` takes it.
fn in_words(list: &RobotMachines) -> String {
    let RobotMachines { made_ms, machines, more } = list;
    let name = |MachineFile { project, path }: &MachineFile| {
        format!("{}/{}\n", harmless(project), harmless(path))
    };
    let names = machines.iter().map(name).collect::<String>();
    let more = if *more > 0 { format!("and {more} that changed earlier\n") } else { String::new() };
    let none = if machines.is_empty() { "no machine in the robot's projects\n" } else { "" };
    format!("as of {} by the robot's calendar\n{names}{none}{more}", utc_text(*made_ms))
}

#[cfg(test)]
mod tests {
    use super::in_words;
    use expect_test::expect;
    use rafcon_protocol::api::{MachineFile, RobotMachines};

    #[test]
    fn machines_are_listed_as_they_are_started() {
        let file = |project: &str, path: &str| MachineFile {
            project: project.to_owned(),
            path: path.to_owned(),
        };
        let machines = vec![file("missions", "drive/far"), file("single", "")];
        let list = RobotMachines { made_ms: 1_795_957_200_000, machines, more: 3 };
        expect![[r"
            as of 2026-11-29T13:00:00Z by the robot's calendar
            missions/drive/far
            single/
            and 3 that changed earlier
        "]]
        .assert_eq(&in_words(&list));
        let list = RobotMachines { made_ms: 1_795_957_200_000, ..RobotMachines::default() };
        expect![[r"
            as of 2026-11-29T13:00:00Z by the robot's calendar
            no machine in the robot's projects
        "]]
        .assert_eq(&in_words(&list));
    }
}
