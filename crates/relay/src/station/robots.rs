//! The robots of a station by their numbers, and the messages of its threads for them.

use super::robot::StationRobot;
use super::{GivenCommand, ToStation};
use crate::carrier::Carrier;

/// Capacity of the messages for a robot whose threads are faster than the message that adds it. Further ones are dropped.
const EARLY_MAX: usize = 256;

/// The robots of a station.
pub(super) struct Robots {
    all: Vec<StationRobot>,
    /// Messages for the robot that is added next.
    early: Vec<ToStation>,
}

impl Robots {
    pub(super) fn new(all: Vec<StationRobot>) -> Self {
        Self { all, early: Vec::new() }
    }

    pub(super) fn iter_mut(&mut self) -> impl Iterator<Item = &mut StationRobot> {
        self.all.iter_mut()
    }

    /// Applies a datagram. The key that opens it identifies its robot.
    pub(super) fn receive(&mut self, from: &Carrier, datagram: &[u8]) {
        let is_opened = self.all.iter_mut().any(|robot| robot.receive(from, datagram));
        if !is_opened {
            self.all.iter_mut().for_each(StationRobot::note_unusable);
        }
    }

    /// Applies a message of the station's threads.
    pub(super) fn handle(&mut self, message: ToStation) {
        let message = match message {
            ToStation::Paired(robot) => return self.add(*robot),
            message => message,
        };
        let number = number_of(&message);
        let Some(robot) = number.and_then(|number| self.all.get_mut(number)) else {
            if self.early.len() < EARLY_MAX {
                self.early.push(message);
            }
            return;
        };
        match message {
            ToStation::Given(GivenCommand { stream, word, .. }) => robot.command(stream, &word),
            ToStation::Disk(_, event) => robot.on_disk_event(event),
            ToStation::Commands(_, event) => robot.on_command_disk_event(event),
            ToStation::Values(_, event) => robot.on_value_disk_event(event),
            ToStation::Paired(_) => {}
        }
    }

    fn add(&mut self, robot: StationRobot) {
        self.all.push(robot);
        for message in std::mem::take(&mut self.early) {
            self.handle(message);
        }
    }
}

/// Number of the robot that a message is for.
fn number_of(message: &ToStation) -> Option<usize> {
    match message {
        ToStation::Given(GivenCommand { robot, .. })
        | ToStation::Disk(robot, _)
        | ToStation::Commands(robot, _)
        | ToStation::Values(robot, _) => Some(*robot),
        ToStation::Paired(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::disk::FromDisk;
    use super::super::robot::tests::robot;
    use super::*;

    #[test]
    fn messages_of_a_robot_wait_up_to_the_bound_until_it_is_added() {
        let folder = tempfile::tempdir().unwrap();
        let (robot, _inbox) = robot(folder.path());
        let mut robots = Robots::new(Vec::new());
        for nth in 0..=EARLY_MAX {
            let problem = FromDisk::Problem(Some(format!("problem {nth}")));
            robots.handle(ToStation::Disk(0, problem));
        }
        assert_eq!(robots.early.len(), EARLY_MAX);
        robots.handle(ToStation::Paired(Box::new(robot)));
        let problems = robots.iter_mut().next().unwrap().report().problems;
        let last = EARLY_MAX - 1;
        assert_eq!(problems, [format!("not everything is kept: problem {last}")]);
        assert!(robots.early.is_empty());
    }
}
