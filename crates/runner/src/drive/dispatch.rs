//! Maps commands to inputs of the engine, or to other actions such as the answer to a question. This module knows the
//! commands, but not their senders.

use crate::drive::error::CommandError;
use crate::drive::record_events::ExtraRecords;
use crate::record::tell;
use crate::{Clock, Driver, Scripts};
use rafcon_engine::{Input, Interrupted, Start, Stride, Then};
use rafcon_model::{OutcomeId, StatePath};
use rafcon_protocol::{Answer, Command, Envelope, Event, Given, OnCrash};
use rafcon_storage::journal::Record;
use smol_str::SmolStr;
use std::sync::{Arc, mpsc};
use std::thread;
use std::time::Duration;

/// The exit status of a runner that a command killed, as in a shell.
const KILLED: i32 = 137;
/// Timeout for recording that the run is killed.
const LAST_LINE: Duration = Duration::from_millis(200);

/// The command behind an action, with its expiry.
pub(crate) struct Order<'o> {
    envelope: Option<&'o Envelope>,
}

impl<'o> Order<'o> {
    /// The order of a command.
    fn of(envelope: &'o Envelope) -> Self {
        Self { envelope: Some(envelope) }
    }

    /// An order without a command: it never expires and is not recorded as a command.
    pub(crate) fn ours() -> Self {
        Self { envelope: None }
    }

    /// True if the command has expired.
    pub(crate) fn is_late(&self) -> bool {
        let expiry = self.envelope.and_then(|envelope| envelope.expiry);
        expiry.is_some_and(|expiry| expiry.0 < Clock::epoch_ms())
    }

    /// The record that the command was applied.
    pub(crate) fn note(&self) -> Option<Record> {
        Some(commanded(self.envelope?, Answer::Applied))
    }
}

fn commanded(envelope: &Envelope, answer: Answer) -> Record {
    tell::told(Event::Commanded { envelope: Box::new(envelope.clone()), answer })
}

/// State of the record of an applied command.
enum Executed {
    /// Recorded in one group with its results: a crash leaves both or none.
    Noted,
    /// Not recorded until now.
    Unnoted,
}

impl<S: Scripts> Driver<S> {
    /// Carries a command out and records it with its answer. Called on any thread, outside the interpreter.
    pub fn obey(self: &Arc<Self>, envelope: &Envelope) -> Answer {
        let answer = match self.carry_out_command(envelope) {
            Ok(Executed::Noted) => return Answer::Applied,
            Ok(Executed::Unnoted) => Answer::Applied,
            Err(CommandError::Late) => Answer::Expired,
            Err(refused) => Answer::Refused { reason: refused.to_string() },
        };
        self.record().note_until_over(commanded(envelope, answer.clone()));
        answer
    }

    fn carry_out_command(self: &Arc<Self>, envelope: &Envelope) -> Result<Executed, CommandError> {
        let order = Order::of(envelope);
        if order.is_late() {
            return Err(CommandError::Late);
        }
        if envelope.not_before.is_some_and(|not_before| not_before > Clock::epoch_ms()) {
            return Err(CommandError::Early);
        }
        match &envelope.command {
            Command::Control { .. } => {}
            Command::Stop | Command::Pause | Command::Kill => self.ground_commands_urgently(),
            _ => self.ground_commands(),
        }
        match &envelope.command {
            Command::Kill => self.kill(envelope),
            Command::SetBreakpoint { breakpoint } => self.set_breakpoint(breakpoint)?,
            Command::RemoveBreakpoint { id } => self.remove_breakpoint(*id)?,
            Command::AnswerQuestion { question, value } => {
                self.questions().answer(*question, value, &envelope.author)?;
            }
            Command::EditScript { path, script } => self.edit_script(path, script)?,
            Command::Reload { wait } => self.reload(*wait)?,
            // Recorded like every command, so that the journal shows the changes of control.
            Command::Control { .. } => {}
            Command::StartFromHistory { sequence } => {
                return self.start_from_history(*sequence, &order).map(|()| Executed::Noted);
            }
            command => return self.carry_out_input(command, &order).map(|()| Executed::Noted),
        }
        Ok(Executed::Unnoted)
    }

    /// Carries out a command that is an input of the engine. A command about the pace of the run also ends a pause by
    /// the journal: a run that is paused until a disk has room stays paused after a pause command.
    fn carry_out_input(
        self: &Arc<Self>,
        command: &Command,
        order: &Order<'_>,
    ) -> Result<(), CommandError> {
        let beside = || ExtraRecords { first: None, last: order.note() };
        if *command == Command::Stop {
            self.reach_for_stop(|why| self.tell_briefly(tell::defect(&why)));
        }
        if !is_about_pace(command) {
            return self.input_beside(self.input_of(command)?, || order.is_late(), beside);
        }
        let input = self.input_of(command)?;
        let mut pauses = self.journal_pauses().lock();
        let is_paused_already = *pauses && *command == Command::Pause && !order.is_late();
        if is_paused_already {
            self.record().note(order.note());
        } else {
            self.input_beside(input, || order.is_late(), beside)?;
        }
        *pauses = false;
        Ok(())
    }

    /// Records something, but waits only a moment for it.
    fn tell_briefly(self: &Arc<Self>, record: Record) {
        let driver = Arc::clone(self);
        let (told, wait) = mpsc::sync_channel::<()>(1);
        let tell = move || {
            driver.record().note([record]);
            drop(told);
        };
        // A failing disk must not prevent the end of a run.
        if thread::Builder::new().name("last line".to_owned()).spawn(tell).is_ok() {
            let _told = wait.recv_timeout(LAST_LINE);
        }
    }

    /// The engine's input for a command.
    fn input_of(&self, command: &Command) -> Result<Input<S::Value>, CommandError> {
        let begin = |path: &str, data, then| self.start(Some(path), data, then);
        Ok(match command {
            Command::Start { from, data } => self.start(from.as_deref(), data, Then::GoOn)?,
            Command::RunSelected { path, data } => begin(path, data, Then::Hold)?,
            Command::RunOnlySelected { path, data } => begin(path, data, Then::Stop)?,
            Command::Pause => Input::Pause,
            Command::Resume { branch } => Input::Resume(state(branch.as_ref())),
            Command::Stop => Input::Stop,
            Command::StepMode => Input::StepMode,
            Command::StepInto { branch } => Input::Step(Stride::Into, state(branch.as_ref())),
            Command::StepOver { branch } => Input::Step(Stride::Over, state(branch.as_ref())),
            Command::StepOut { branch } => Input::Step(Stride::Out, state(branch.as_ref())),
            Command::StepBack { branch } => Input::Step(Stride::Back, state(branch.as_ref())),
            Command::RunTo { path } => Input::RunTo(StatePath::parse(path)),
            Command::ForceOutcome { path, outcome } => {
                Input::Force(StatePath::parse(path), OutcomeId(*outcome))
            }
            Command::Preempt { path } => Input::Preempt(StatePath::parse(path)),
            Command::Recover { path, policy } => {
                Input::Recover(state(path.as_ref()), recovery(*policy)?)
            }
            Command::Kill
            | Command::StartFromHistory { .. }
            | Command::SetBreakpoint { .. }
            | Command::RemoveBreakpoint { .. }
            | Command::AnswerQuestion { .. }
            | Command::Reload { .. }
            | Command::EditScript { .. }
            | Command::Control { .. } => return Err(CommandError::NotAnInput),
        })
    }

    fn start(
        &self,
        from: Option<&str>,
        data: &[Given],
        then: Then,
    ) -> Result<Input<S::Value>, CommandError> {
        let given = data.iter().map(|given| self.given(given)).collect::<Result<_, _>>()?;
        let start_from = from.map(StatePath::parse);
        Ok(Input::Start(Start { start_from, given, then, ..Start::default() }))
    }

    fn given(&self, given: &Given) -> Result<(StatePath, SmolStr, S::Value), CommandError> {
        let value = self.scripts().value(&given.value).map_err(|why| CommandError::Value {
            name: given.name.clone(),
            path: given.path.clone(),
            why,
        })?;
        Ok((StatePath::parse(&given.path), given.name.as_str().into(), value))
    }

    /// Ends the process without waiting for its scripts. Viewers see the connection end.
    fn kill(self: &Arc<Self>, envelope: &Envelope) -> ! {
        self.tell_briefly(commanded(envelope, Answer::Applied));
        signal_hook::low_level::exit(KILLED)
    }
}

fn is_about_pace(command: &Command) -> bool {
    matches!(
        command,
        Command::Pause
            | Command::Resume { .. }
            | Command::StepMode
            | Command::StepInto { .. }
            | Command::StepOver { .. }
            | Command::StepOut { .. }
            | Command::StepBack { .. }
            | Command::RunTo { .. }
    )
}

fn state(path: Option<&String>) -> Option<StatePath> {
    path.map(|path| StatePath::parse(path))
}

fn recovery(policy: OnCrash) -> Result<Interrupted, CommandError> {
    match policy {
        OnCrash::Abort => Ok(Interrupted::Abort),
        OnCrash::Restart => Ok(Interrupted::Again),
        OnCrash::Ask => Err(CommandError::Undecided),
    }
}
