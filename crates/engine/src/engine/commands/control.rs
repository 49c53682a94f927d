//! Commands, and the statuses in which each is legal.

use crate::engine::state::step::{Step, View};
use crate::engine::state::suspended::StopPoint;
use crate::engine::{Command, Refusal, Status};
use crate::{Datum, Effect, Event, Input, Stride, When};

/// True if a command is legal in a status. `docs/semantics.md` has the table.
fn is_legal(status: Status, command: Command) -> bool {
    match command {
        Command::Attended | Command::Silence => true,
        Command::Break | Command::Unbreak | Command::Change => status != Status::Finished,
        Command::Start | Command::Restore => match status {
            Status::Idle | Status::Running | Status::Paused | Status::Stepping => true,
            Status::Stopping | Status::Finished => false,
        },
        Command::Pause => matches!(status, Status::Running | Status::Stepping),
        Command::Resume | Command::Step => matches!(status, Status::Paused | Status::Stepping),
        Command::StepMode | Command::RunTo | Command::Force => match status {
            Status::Running | Status::Paused | Status::Stepping => true,
            Status::Idle | Status::Stopping | Status::Finished => false,
        },
        Command::Stop | Command::Preempt | Command::Recover => match status {
            Status::Running | Status::Paused | Status::Stepping | Status::Stopping => true,
            Status::Idle | Status::Finished => false,
        },
    }
}

impl<D: Datum> Step<'_, D> {
    /// Accepts an input and queues the work that follows from it.
    pub(in crate::engine) fn take(&mut self, input: Input<D>) -> Result<(), Refusal> {
        if let Some(command) = command(&input) {
            self.view().legal(command)?;
        }
        match input {
            Input::Finished { frame, result } => return self.script_ended(frame, result),
            Input::Checked { check, result } => return self.checked(check, result),
            Input::Start(start) => return self.start(start),
            Input::Restore(restore) => return self.restore(*restore),
            Input::Resume(branch) => return self.resume(branch.as_ref()),
            Input::Step(Stride::Back, branch) => return self.back(branch.as_ref()),
            Input::Force(path, outcome) => return self.force(&path, outcome),
            Input::Preempt(path) => return self.preempt_at(&path),
            // Handled in `Engine::handle`, because it replaces the program.
            Input::Change(_) => {}
            Input::Step(stride, branch) => return self.forward(stride, branch.as_ref()),
            Input::RunTo(path) => return self.run_to(path),
            Input::Recover(path, how) => return self.recover(path.as_ref(), how),
            Input::Unbreak(id) => return self.remove_breakpoint(id),
            Input::Pause => self.pause(true),
            Input::Stop => self.stop(),
            Input::StepMode => self.step_mode(),
            Input::Break(breakpoint) => self.run.control.breakpoints.set(breakpoint),
            Input::Attended(attended) => self.attend(attended),
            Input::Silence(silence) => self.set_silence(silence),
        }
        Ok(())
    }

    pub(in crate::engine) fn pause(&mut self, paused: bool) {
        self.run.status = if paused { Status::Paused } else { Status::Running };
        self.run.control.paused_by = None;
        self.out.events.push(Event::Paused(paused));
        self.out.effects.push(Effect::Paused(paused));
    }

    pub(in crate::engine) fn stop(&mut self) {
        if self.run.status == Status::Paused {
            self.pause(false);
        }
        self.run.stopped_twice = self.run.status == Status::Stopping;
        self.run.status = Status::Stopping;
        self.run.control.stop_next = false;
        self.run.branches.set_all(false);
        self.out.events.push(Event::Stopping);
        let active = self.view().active();
        self.preempt(&active);
        if !self.run.control.take_in(StopPoint::root(When::Before).parent).is_empty() {
            self.finish();
        }
    }

    fn remove_breakpoint(&mut self, id: u64) -> Result<(), Refusal> {
        let was_there = self.run.control.breakpoints.remove(id);
        was_there.then_some(()).ok_or(Refusal::NoSuchBreakpoint { id })
    }
}

impl<D: Datum> View<'_, '_, D> {
    pub(in crate::engine) fn legal(&self, command: Command) -> Result<(), Refusal> {
        let status = self.run.status();
        is_legal(status, command).then_some(()).ok_or(Refusal::NotNow { command, status })
    }

    pub(in crate::engine) fn active(&self) -> Vec<u32> {
        self.run.root.map(|root| self.run.frames.below(root)).unwrap_or_default()
    }
}

/// The command of an input; `None` for results.
fn command<D>(input: &Input<D>) -> Option<Command> {
    Some(match input {
        Input::Finished { .. } | Input::Checked { .. } => return None,
        Input::Start(_) => Command::Start,
        Input::Restore(_) => Command::Restore,
        Input::Pause => Command::Pause,
        Input::Resume(_) => Command::Resume,
        Input::Stop => Command::Stop,
        Input::StepMode => Command::StepMode,
        Input::Step(..) => Command::Step,
        Input::RunTo(_) => Command::RunTo,
        Input::Force(..) => Command::Force,
        Input::Preempt(_) => Command::Preempt,
        Input::Recover(..) => Command::Recover,
        Input::Break(_) => Command::Break,
        Input::Unbreak(_) => Command::Unbreak,
        Input::Attended(_) => Command::Attended,
        Input::Silence(_) => Command::Silence,
        Input::Change(_) => Command::Change,
    })
}

#[cfg(test)]
mod tests {
    use super::{Command, Status, is_legal};
    use expect_test::expect;

    #[test]
    fn the_table() {
        let statuses = [
            Status::Idle,
            Status::Running,
            Status::Paused,
            Status::Stepping,
            Status::Stopping,
            Status::Finished,
        ];
        let commands = [
            Command::Start,
            Command::Restore,
            Command::Pause,
            Command::Resume,
            Command::Stop,
            Command::StepMode,
            Command::Step,
            Command::RunTo,
            Command::Force,
            Command::Preempt,
            Command::Recover,
            Command::Break,
            Command::Unbreak,
            Command::Attended,
            Command::Silence,
            Command::Change,
        ];
        let mark = |legal: bool| if legal { " taken |" } else { " – |" };
        let rows = commands.map(|command| {
            let marks = statuses.map(|status| mark(is_legal(status, command)));
            format!("| {command} |{}\n", marks.concat())
        });
        expect![[r"
            | start | taken | taken | taken | taken | – | – |
            | restore the run | taken | taken | taken | taken | – | – |
            | pause | – | taken | – | taken | – | – |
            | resume | – | – | taken | taken | – | – |
            | stop | – | taken | taken | taken | taken | – |
            | begin to step | – | taken | taken | taken | – | – |
            | step | – | – | taken | taken | – | – |
            | run to a state | – | taken | taken | taken | – | – |
            | force an outcome | – | taken | taken | taken | – | – |
            | preempt a state | – | taken | taken | taken | taken | – |
            | recover | – | taken | taken | taken | taken | – |
            | set a breakpoint | taken | taken | taken | taken | taken | – |
            | remove a breakpoint | taken | taken | taken | taken | taken | – |
            | note whether a viewer is connected | taken | taken | taken | taken | taken | taken |
            | note how long the ground is silent | taken | taken | taken | taken | taken | taken |
            | change the machine | taken | taken | taken | taken | taken | – |
        "]]
        .assert_eq(&rows.concat());
    }
}
