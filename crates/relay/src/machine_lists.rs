//! The lists of the robots' machines at a station, shared between the station's disk threads and its server.

use crate::parcels::stored_machine_list;
use parking_lot::Mutex;
use rafcon_protocol::api::RobotMachines;
use std::collections::BTreeMap;
use std::io;
use std::path::Path;
use std::sync::Arc;

/// The folder for parcels of machines in the folder of a robot.
pub(crate) const MACHINES_FOLDER: &str = "machines";

/// Lists of the machines in the projects of each robot that a station receives.
#[derive(Debug, Clone, Default)]
pub struct MachineLists(Arc<Mutex<BTreeMap<String, Option<RobotMachines>>>>);

/// Reason why the machines of a robot are unknown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum MachinesUnknown {
    /// The station does not receive this robot.
    #[error("this server does not receive the robot now: run it as its station (`rafcon station`)")]
    NotReceived,
    /// The robot has sent no list.
    #[error(
        "no list of its machines has arrived yet: repeat this once there is a signal of the robot, or start a machine by its path"
    )]
    NotArrived,
}

impl MachineLists {
    /// The list of a robot's machines that arrived last.
    pub fn of(&self, robot: &str) -> Result<RobotMachines, MachinesUnknown> {
        let lists = self.0.lock();
        let list = lists.get(robot).ok_or(MachinesUnknown::NotReceived)?;
        list.clone().ok_or(MachinesUnknown::NotArrived)
    }

    /// Names of the robots that the station receives.
    pub fn robots(&self) -> Vec<String> {
        self.0.lock().keys().cloned().collect()
    }

    /// Notes the list of a robot that the station receives.
    pub(crate) fn set(&self, robot: &str, list: Option<RobotMachines>) {
        self.0.lock().insert(robot.to_owned(), list);
    }
}

/// The list of machines in the folder of a robot at its station, read from the disk. `None` if none has arrived.
pub fn read_machine_list(robot_folder: &Path) -> io::Result<Option<RobotMachines>> {
    stored_machine_list(&robot_folder.join(MACHINES_FOLDER))
}
