//! Commands, and in which status each is legal.

use super::phase::Cause;
use super::step::Step;
use super::{Command, Refusal, Status};
use crate::{Datum, Effect, Event, Input, Start};

/// What a command does in a status.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Action {
    Begin,
    Pause,
    Resume,
    Stop,
    StopPaused,
    Restore,
    Change,
}

/// The table. The same rows stand in `docs/semantics.md`.
fn action(status: Status, command: Command) -> Option<Action> {
    let action = match (status, command) {
        (Status::Idle, Command::Start) => Action::Begin,
        (Status::Running, Command::Pause) => Action::Pause,
        (Status::Paused, Command::Resume) => Action::Resume,
        (Status::Running | Status::Stopping, Command::Stop) => Action::Stop,
        (Status::Paused, Command::Stop) => Action::StopPaused,
        (Status::Idle | Status::Running | Status::Paused, Command::Restore) => Action::Restore,
        (_, Command::Change) if status != Status::Finished => Action::Change,
        (Status::Idle, Command::Pause | Command::Resume | Command::Stop)
        | (Status::Running, Command::Start | Command::Resume)
        | (Status::Paused, Command::Start | Command::Pause)
        | (
            Status::Stopping,
            Command::Start | Command::Pause | Command::Resume | Command::Restore,
        )
        | (
            Status::Finished,
            Command::Start | Command::Pause | Command::Resume | Command::Stop | Command::Restore,
        )
        | (_, Command::Change) => return None,
    };
    Some(action)
}

impl<D: Datum> Step<'_, D> {
    /// Takes an input; what follows from it is left as work.
    pub(super) fn take(&mut self, input: Input<D>) -> Result<(), Refusal> {
        match input {
            Input::Finished { frame, result } => self.script_ended(frame, result),
            Input::Start(start) => self.start(&start),
            Input::Pause => self.obey(Command::Pause),
            Input::Resume(None) => self.obey(Command::Resume),
            Input::Stop => self.obey(Command::Stop),
            Input::Restore(restore) => self.restore(*restore),
            Input::Recover(path, interrupted) => self.recover(path.as_ref(), interrupted),
            Input::Resume(Some(_))
            | Input::StepMode
            | Input::Step(..)
            | Input::RunTo(_)
            | Input::Force(..)
            | Input::Preempt(_)
            | Input::Break(_)
            | Input::Unbreak(_)
            | Input::Attended(_)
            | Input::Change(_)
            | Input::Checked { .. } => Err(Refusal::NotYet),
        }
    }

    pub(super) fn legal(&self, command: Command) -> Result<Action, Refusal> {
        let status = self.run.status;
        action(status, command).ok_or(Refusal::NotNow { command, status })
    }

    fn obey(&mut self, command: Command) -> Result<(), Refusal> {
        match self.legal(command)? {
            Action::Begin => self.run.status = Status::Running,
            Action::Pause => self.pause(true),
            Action::Restore | Action::Change => {}
            Action::Resume => self.resume(),
            Action::Stop => self.stop(),
            Action::StopPaused => {
                self.pause(false);
                self.stop();
            }
        }
        Ok(())
    }

    fn start(&mut self, start: &Start<D>) -> Result<(), Refusal> {
        self.legal(Command::Start)?;
        if let Some(path) = &start.start_from {
            self.run.start_from = self.program.descend(path)?.1;
        }
        self.obey(Command::Start)?;
        self.enter_root(&start.inputs);
        Ok(())
    }

    pub(super) fn pause(&mut self, paused: bool) {
        self.run.status = if paused { Status::Paused } else { Status::Running };
        self.out.events.push(Event::Paused(paused));
        self.out.effects.push(Effect::Paused(paused));
    }

    fn resume(&mut self) {
        self.pause(false);
        let active = self.active();
        self.wake(&active, Cause::Resumed);
    }

    fn stop(&mut self) {
        self.run.stopped_twice = self.run.status == Status::Stopping;
        self.run.status = Status::Stopping;
        self.out.events.push(Event::Stopping);
        let active = self.active();
        self.preempt(&active);
    }

    pub(super) fn active(&self) -> Vec<u32> {
        self.run.root.map(|root| self.run.frames.below(root)).unwrap_or_default()
    }
}
