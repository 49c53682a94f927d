//! Takes the frames of the station.

use super::outgoing::Outgoing;
use super::scheduled_commands;
use super::{ReceivedCommand, RobotSession, SUBSCRIPTIONS_MAX};
use crate::endpoint::{Arrived, Unusable};
use crate::frame::{
    self, Body, CommandId, CommandState, Fetch, Frame, Received, Terms, ValueFrame,
};
use crate::send_rate::Arrivals;
use crate::session_time::SessionTime;

impl RobotSession {
    /// Handles a received datagram. `carry_out` receives each command once per start. A late command counts as expired, unless the
    /// caller knows its fate from an earlier start and sets it.
    pub fn handle_datagram(
        &mut self,
        now: SessionTime,
        datagram: &mut [u8],
        mut carry_out: impl FnMut(ReceivedCommand),
    ) -> Result<(), Unusable> {
        let Arrived { frames, is_new_start, at_ms, .. } = self.end.open(now, datagram)?;
        if is_new_start {
            self.streams.values_mut().for_each(Outgoing::station_started);
        }
        let (mut echo, mut reports, mut fetches) = (None, Vec::new(), Vec::new());
        let (mut newest, mut arrived) = (None, None);
        for frame in frames {
            match frame? {
                Frame::Heard { start, number, newest_ms, held_ms, late_ms }
                    if start == self.end.start.generation =>
                {
                    self.end.confirm(number);
                    echo = Some((newest_ms, late_ms));
                    newest = Some((newest_ms, at_ms.saturating_sub(held_ms)));
                }
                Frame::Arrived { bytes, longest } => arrived = Some((bytes, longest)),
                Frame::Received(received) => reports.push(received),
                Frame::Value(frame) => self.take(frame, &mut fetches),
                Frame::Command(frame::Command { id, terms, body }) => {
                    if let Some(state) = self.states.get_mut(&id) {
                        (state.sends, state.due) = (0, now);
                        continue;
                    }
                    let whole = match body {
                        Body::Whole(bytes) => Some(bytes.to_vec()),
                        Body::Parts(length) => self.incomplete.take_head(now, id, length, terms),
                    };
                    let passed = whole.and_then(|body| self.take_command(now, id, terms, body));
                    passed.into_iter().for_each(&mut carry_out);
                }
                Frame::CommandPart(part) if !self.states.contains_key(&part.id) => {
                    let whole = self.incomplete.take_part(now + self.profile.gather, &part);
                    let passed = whole
                        .and_then(|(terms, body)| self.take_command(now, part.id, terms, body));
                    passed.into_iter().for_each(&mut carry_out);
                }
                _ => {}
            }
        }
        self.report(now, echo, reports);
        if let (Some((newest_ms, arrived_ms)), Some((bytes, longest))) = (newest, arrived) {
            let arrivals = Arrivals { bytes, at_ms, newest_ms, arrived_ms };
            self.rate.report(now, arrivals, self.report_age.unwrap_or_default());
            let sends = self.rate.sends();
            self.streams.values_mut().for_each(|stream| stream.set_sends(sends));
            let late_ms = echo.map_or(0, |(_, late_ms)| late_ms);
            let longest = usize::try_from(longest).unwrap_or(usize::MAX);
            if self.end.path.report(now, longest, bytes, newest_ms.saturating_sub(late_ms)) {
                self.streams.values_mut().for_each(Outgoing::datagrams_shortened);
            }
        }
        for fetch in fetches {
            self.values.wanted(now, fetch, echo, &self.profile);
        }
        Ok(())
    }

    /// Returns a new command that is to be passed on; keeps it if its time has not come.
    pub(super) fn take_command(
        &mut self,
        now: SessionTime,
        id: CommandId,
        terms: Terms,
        body: Vec<u8>,
    ) -> Option<ReceivedCommand> {
        let Terms { robot_start, not_after_ms, not_before_ms, epoch } = terms;
        let is_late = robot_start != self.end.start.generation || now.as_millis() > not_after_ms;
        let new = ReceivedCommand { id, epoch, not_after_ms, not_before_ms, is_late, body };
        let (state, why, passed) = if is_late {
            (CommandState::Expired, "", Some(new))
        } else if now.as_millis() >= not_before_ms {
            (CommandState::Received, "", Some(new))
        } else if self.scheduled.add(new) {
            (CommandState::Received, "", None)
        } else {
            (CommandState::Refused, scheduled_commands::TOO_MANY, None)
        };
        self.set_command_state(now, id, state, why);
        passed
    }

    /// The next scheduled command whose time has come; each is returned once.
    pub fn poll_command(&mut self, now: SessionTime) -> Option<ReceivedCommand> {
        while let Some(command) = self.scheduled.take(now.as_millis()) {
            if now.as_millis() <= command.not_after_ms {
                return Some(command);
            }
            self.set_command_state(now, command.id, CommandState::Expired, "");
        }
        None
    }

    pub(super) fn take(&mut self, frame: ValueFrame<'_>, fetches: &mut Vec<Fetch>) {
        match frame {
            ValueFrame::Fetch(fetch) => fetches.push(fetch),
            // One that has no room does not count, so the station repeats it.
            ValueFrame::Watch(part)
                if self.subscriptions.len() < SUBSCRIPTIONS_MAX
                    && self.streams.contains_key(&part.stream) =>
            {
                self.subscriptions.extend(self.watched.add_part(&part));
            }
            _ => {}
        }
    }

    fn report(&mut self, now: SessionTime, echo: Option<(u64, u64)>, reports: Vec<Received>) {
        let age = echo.map(|(newest_ms, _)| now.since(SessionTime::from_millis(newest_ms)));
        self.report_age = self.report_age.into_iter().chain(age).min();
        let usual = self.report_age.unwrap_or_default() * 2 + self.profile.silence();
        let is_late = age.is_none_or(|age| age > usual);
        for mut received in reports {
            if is_late {
                // It waited somewhere while the link was cut: since then, the station may have started again.
                (received.context, received.snapshot) = (None, None);
            }
            if let Some(stream) = self.streams.get_mut(&received.stream) {
                stream.report(now, received, echo, &self.profile);
            }
        }
    }
}
