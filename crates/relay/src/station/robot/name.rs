//! Name of a robot, and the receiver of its problems.

/// A robot as its station's messages name it.
#[derive(Debug, Clone)]
pub(in crate::station) struct RobotName {
    name: String,
    tell: fn(&str),
}

impl RobotName {
    pub(super) fn new(name: &str, tell: fn(&str)) -> Self {
        Self { name: name.to_owned(), tell }
    }

    pub(super) fn as_str(&self) -> &str {
        &self.name
    }

    /// Reports a problem of this robot.
    pub(super) fn tell(&self, problem: &str) {
        (self.tell)(&format!("robot {}: {problem}", self.name));
    }
}
