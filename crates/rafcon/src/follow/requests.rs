//! Requests of the user, by signals and keys, and the commands that follow from them.

use super::stop_requests::{REPETITION, StopSignal};
use super::{Action, End, RunFollower, RunRole, envelope};
use crate::console::UserAction;
use rafcon_protocol::{Command, ToRunner};
use std::time::Duration;

impl RunFollower {
    /// Handles a stop signal. A guest leaves at the first request. Others stop the run, then kill it, and at last leave a
    /// run at a server.
    pub(super) fn interrupt(&mut self, now: Duration, signal: StopSignal, out: &mut Vec<Action>) {
        let request = self.stop_requests.add(now, signal);
        let takes_a_stop = match self.role {
            RunRole::Guest => false,
            RunRole::Host => true,
            RunRole::Owner => self.is_greeted && self.end.is_none(),
        };
        match (request, self.role) {
            (None, _) => self.repeated(signal, out),
            (Some(1), _) if takes_a_stop => {
                self.say(&format!("stopping; {}", again("kill")), Command::Stop, out);
            }
            (Some(_), RunRole::Owner) => self.kill(self.killed(), out),
            (Some(2), RunRole::Host) => {
                self.have_killed(&format!("killing; {}", again("leave the run as it is")), out);
            }
            (Some(_), RunRole::Guest | RunRole::Host) => self.finish(End::Left),
        }
    }

    /// Reports that a Ctrl-C came too soon to be another request.
    fn repeated(&self, signal: StopSignal, out: &mut Vec<Action>) {
        if signal == StopSignal::CtrlC && self.end.is_none() {
            let next = if self.is_kill_sent { "leave the run as it is" } else { "kill" };
            out.push(Action::Note(again(next)));
        }
    }

    /// Performs the action of a key.
    pub(super) fn wish(&mut self, wish: UserAction, out: &mut Vec<Action>) {
        match wish {
            UserAction::Send(command) => self.send(command, out),
            UserAction::Inspect(path) => {
                let id = self.next_id();
                out.push(Action::Send(ToRunner::Inspect { id, path }));
            }
            UserAction::Say(text) => out.push(Action::Note(text)),
            UserAction::Leave => {}
        }
    }

    pub(super) fn say(&mut self, text: &str, command: Command, out: &mut Vec<Action>) {
        out.push(Action::Note(text.to_owned()));
        self.send(command, out);
    }

    pub(super) fn send(&mut self, command: Command, out: &mut Vec<Action>) {
        let envelope = envelope(self.next_id(), &self.author, command);
        out.push(Action::Send(ToRunner::Command(envelope)));
    }

    fn next_id(&mut self) -> String {
        self.commands += 1;
        format!("{}-{}", self.prefix, self.commands)
    }

    /// Makes an external run kill itself.
    pub(super) fn have_killed(&mut self, text: &str, out: &mut Vec<Action>) {
        self.kill_at = None;
        self.is_kill_sent = true;
        self.say(text, Command::Kill, out);
    }
}

/// Hint for the next request of the user.
fn again(what: &str) -> String {
    format!("press Ctrl-C again after {} s to {what}", REPETITION.as_secs())
}
