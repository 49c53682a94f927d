//! Control of a run: one holder at a time, who can be asked for control, hand it over, or lose it by silence. Pure: time is an
//! argument. Knows users by name, but not their commands.

use rafcon_protocol::api::{Control, ControlMove};
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// Maximum number of pending requests.
const REQUESTS_MAX: usize = 64;

/// Holder of control of a run, and the pending requests. Without a holder, no request is pending.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub(super) struct Holding {
    holder: Option<ControlHolder>,
    requests: Vec<String>,
    /// The user to whom the holder offers control.
    #[serde(default)]
    offered_to: Option<String>,
    /// Increments each time control passes.
    #[serde(default)]
    epoch: u64,
    /// Commands decided before this epoch are void.
    #[serde(default)]
    valid_from: u64,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct ControlHolder {
    user: String,
    since_ms: u64,
    /// Not stored: after a restart of the server, the silence of the holder starts anew.
    #[serde(skip)]
    heard_ms: u64,
    /// The command by which the holder took control from nobody, until the next command.
    #[serde(skip)]
    first: Option<FirstCommand>,
}

/// A command that took control from nobody.
#[derive(Debug, Clone, PartialEq, Eq)]
struct FirstCommand {
    id: String,
    /// Value of `valid_from` before the command.
    valid_from: u64,
}

/// Reason why control does not pass, or why a command is denied.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub(super) enum Denied {
    /// Another user holds control.
    #[error(
        "{holder} holds control of this run: request it (POST …/control with \"move\": \"request\"), or take it over \
         when they have been silent for {silence_s} s; stop and pause need no control"
    )]
    Held {
        /// The user who holds control.
        holder: String,
        /// Seconds of silence after which control can be taken over.
        silence_s: u64,
    },
    /// The holder was active recently.
    #[error(
        "{holder} was active {heard_s} s ago: control can be taken over after {silence_s} s of silence; request it meanwhile"
    )]
    Heard {
        /// The user who holds control.
        holder: String,
        /// Seconds since the holder's last activity.
        heard_s: u64,
        /// Seconds of silence after which control can be taken over.
        silence_s: u64,
    },
    /// Only a holder can do this, and nobody holds control.
    #[error(
        "nobody holds control of this run: the first who commands takes it, or who requests it"
    )]
    Nobody,
    /// The name of the new holder is invalid.
    #[error("control is handed over to a user: a name of 1 to 64 characters")]
    NoName,
    /// Control is not offered to this user.
    #[error("nobody offers you control of this run: request it (\"move\": \"request\")")]
    NotOffered,
    /// Control has passed since the command was decided on.
    #[error(
        "this was decided under epoch {decided} of authority, and control has passed since: epoch {epoch} is in force; look at the run \
         and decide again"
    )]
    Epoch {
        /// The epoch of the command.
        decided: u64,
        /// The epoch in force.
        epoch: u64,
    },
    /// Too many requests for control are pending.
    #[error(
        "{REQUESTS_MAX} users ask for control of this run already: wait until some of them have withdrawn"
    )]
    TooMany,
}

/// A command that requires control.
#[derive(Debug, Clone, Copy)]
pub(super) struct GivenCommand<'c> {
    /// Author of the command.
    pub(super) user: &'c str,
    /// Id, prefixed by the author's name.
    pub(super) id: &'c str,
    /// The epoch under which the author decided, if known.
    pub(super) epoch: Option<u64>,
}

impl Holding {
    /// Restores the stored state on a server that serves the run from `now_ms` on.
    pub(super) fn go_on(mut self, now_ms: u64) -> Self {
        if let Some(holder) = &mut self.holder {
            holder.heard_ms = now_ms;
        }
        self
    }

    /// The clock was set by `step_ms`. Shifts all times, so that the silence stays correct.
    pub(super) fn shift(&mut self, step_ms: i64) {
        if let Some(holder) = &mut self.holder {
            for time in [&mut holder.since_ms, &mut holder.heard_ms] {
                *time = time.saturating_add_signed(step_ms);
            }
        }
    }

    /// The user who holds control.
    pub(super) fn holder(&self) -> Option<&str> {
        self.holder.as_ref().map(|holder| holder.user.as_str())
    }

    /// The current epoch of authority.
    pub(super) fn epoch(&self) -> u64 {
        self.epoch
    }

    /// Denies a decision under an epoch that is no longer valid.
    fn check_epoch(&self, decided: Option<u64>) -> Result<(), Denied> {
        let is_valid = |decided: &u64| (self.valid_from..=self.epoch).contains(decided);
        match decided.filter(|decided| !is_valid(decided)) {
            Some(decided) => Err(Denied::Epoch { decided, epoch: self.epoch }),
            None => Ok(()),
        }
    }

    /// The state of control for clients.
    pub(super) fn told(&self, silence: Duration) -> Control {
        let holder = self.holder.as_ref();
        Control {
            holder: holder.map(|holder| holder.user.clone()),
            since_ms: holder.map_or(0, |holder| holder.since_ms),
            heard_ms: holder.map_or(0, |holder| holder.heard_ms),
            silence_ms: millis(silence),
            requests: self.requests.clone(),
            offered_to: self.offered_to.clone(),
            epoch: self.epoch,
        }
    }

    /// Notes activity of a user. Returns `true` for the holder.
    pub(super) fn heard(&mut self, user: &str, now_ms: u64) -> bool {
        match &mut self.holder {
            Some(holder) if holder.user == user => {
                holder.heard_ms = holder.heard_ms.max(now_ms);
                true
            }
            _ => false,
        }
    }

    /// Checks a command. The first author takes control; others than the holder are denied. Skip it for commands open to everyone.
    pub(super) fn command(
        &mut self,
        GivenCommand { user, id, epoch }: GivenCommand<'_>,
        now_ms: u64,
        silence: Duration,
    ) -> Result<(), Denied> {
        if let Some(holder) = self.holder.as_ref().filter(|holder| holder.user != user) {
            return Err(holder.denies(silence));
        }
        self.check_epoch(epoch)?;
        let valid_from = self.valid_from;
        let is_first = !self.heard(user, now_ms);
        if is_first {
            self.give(user, now_ms);
        }
        if let Some(holder) = &mut self.holder {
            let first = FirstCommand { id: id.to_owned(), valid_from };
            holder.first = if is_first { Some(first) } else { holder.first.take() };
            holder.first.take_if(|first| first.id != id);
        }
        Ok(())
    }

    /// The run refused a command. If its author took control by it and gave no other, control is released, and earlier decisions of
    /// others are valid again.
    pub(super) fn refused(&mut self, id: &str, now_ms: u64) {
        let first = self.holder.as_ref().and_then(|holder| holder.first.as_ref());
        let Some(FirstCommand { valid_from, .. }) = first.filter(|first| first.id == id).cloned()
        else {
            return;
        };
        self.let_go(now_ms);
        if self.holder.is_none() {
            self.valid_from = valid_from;
        }
    }

    /// Applies a user's request about control.
    pub(super) fn apply(
        &mut self,
        user: &str,
        wanted: &ControlMove,
        now_ms: u64,
        silence: Duration,
    ) -> Result<(), Denied> {
        self.heard(user, now_ms);
        match wanted {
            ControlMove::Request => return self.request(user, now_ms),
            ControlMove::Withdraw => self.withdraw(user),
            ControlMove::HandOver { to } => {
                self.own(user, silence)?;
                if to.is_empty() || to.chars().count() > 64 {
                    return Err(Denied::NoName);
                }
                self.hand_over(to, now_ms);
            }
            ControlMove::Release => {
                self.own(user, silence)?;
                self.let_go(now_ms);
            }
            ControlMove::TakeOver => self.take_over(user, now_ms, silence)?,
            ControlMove::Accept => {
                self.answer_offer(user)?;
                self.give(user, now_ms);
            }
            ControlMove::Decline => self.answer_offer(user)?,
            ControlMove::Override => self.give(user, now_ms),
        }
        Ok(())
    }

    fn request(&mut self, user: &str, now_ms: u64) -> Result<(), Denied> {
        let Some(holder) = &self.holder else {
            self.give(user, now_ms);
            return Ok(());
        };
        if self.offered_to.as_deref() == Some(user) {
            self.give(user, now_ms);
            return Ok(());
        }
        if holder.user == user || self.requests.iter().any(|other| other == user) {
            return Ok(());
        }
        if self.requests.len() >= REQUESTS_MAX {
            return Err(Denied::TooMany);
        }
        self.requests.push(user.to_owned());
        Ok(())
    }

    fn withdraw(&mut self, user: &str) {
        if self.holder() == Some(user) {
            self.offered_to = None;
        }
        self.requests.retain(|other| other != user);
    }

    /// Gives control to a user who requested it, or offers it to any other user.
    fn hand_over(&mut self, to: &str, now_ms: u64) {
        if self.requests.iter().any(|other| other == to) || self.holder() == Some(to) {
            self.give(to, now_ms);
        } else {
            self.offered_to = Some(to.to_owned());
        }
    }

    /// Ends the offer to this user.
    fn answer_offer(&mut self, user: &str) -> Result<(), Denied> {
        if self.offered_to.as_deref() != Some(user) {
            return Err(Denied::NotOffered);
        }
        self.offered_to = None;
        Ok(())
    }

    fn take_over(&mut self, user: &str, now_ms: u64, silence: Duration) -> Result<(), Denied> {
        if let Some(holder) = &self.holder {
            let silent_ms = now_ms.saturating_sub(holder.heard_ms);
            if holder.user != user && silent_ms < millis(silence) {
                return Err(Denied::Heard {
                    holder: holder.user.clone(),
                    heard_s: silent_ms / 1000,
                    silence_s: silence.as_secs(),
                });
            }
        }
        self.give(user, now_ms);
        Ok(())
    }

    /// Denies users other than the holder.
    fn own(&self, user: &str, silence: Duration) -> Result<(), Denied> {
        match &self.holder {
            None => Err(Denied::Nobody),
            Some(holder) if holder.user == user => Ok(()),
            Some(holder) => Err(holder.denies(silence)),
        }
    }

    /// Releases control. The first pending request gets it.
    fn let_go(&mut self, now_ms: u64) {
        self.holder = None;
        self.offered_to = None;
        self.pass();
        if !self.requests.is_empty() {
            let first = self.requests.remove(0);
            self.give(&first, now_ms);
        }
    }

    fn give(&mut self, user: &str, now_ms: u64) {
        self.requests.retain(|other| other != user);
        self.offered_to = None;
        if self.holder() != Some(user) {
            // The new holder has taken it from nobody and cannot have seen the new epoch.
            let (was_free, before) = (self.holder.is_none(), self.epoch);
            self.pass();
            if was_free {
                self.valid_from = before;
            }
            self.holder = Some(ControlHolder {
                user: user.to_owned(),
                since_ms: now_ms,
                heard_ms: now_ms,
                first: None,
            });
        }
    }

    /// Starts a new epoch: earlier decisions are void.
    fn pass(&mut self) {
        self.epoch += 1;
        self.valid_from = self.epoch;
    }
}

impl ControlHolder {
    fn denies(&self, silence: Duration) -> Denied {
        Denied::Held { holder: self.user.clone(), silence_s: silence.as_secs() }
    }
}

fn millis(time: Duration) -> u64 {
    u64::try_from(time.as_millis()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests;
