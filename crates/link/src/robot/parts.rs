//! Commands that come in parts, until they are whole.

use crate::assembly::Assembly;
use crate::frame::{CommandId, CommandPart, Frame, PartsHere, Terms};
use crate::payload_writer::PayloadWriter;
use crate::range_set::RangeSet;
use crate::session_time::SessionTime;
use std::collections::VecDeque;
use std::time::Duration;

/// Capacity. Beyond it, the oldest is dropped: the station sends its parts again.
pub(crate) const INCOMPLETE_MAX: usize = 8;
/// Sends of a report on the parts that are here.
const REPORT_SENDS: u8 = 2;

/// Commands of which parts are here, the oldest first.
#[derive(Debug, Default)]
pub(super) struct IncompleteCommands(VecDeque<Incomplete>);

#[derive(Debug)]
struct Incomplete {
    id: CommandId,
    length: u32,
    parts: Assembly,
    body: Option<Vec<u8>>,
    terms: Option<Terms>,
    reports_left: u8,
    report_at: SessionTime,
}

impl IncompleteCommands {
    /// Takes a part. Its report may wait for other parts until `report_at`. Returns terms and body of a command that is whole.
    pub(super) fn take_part(
        &mut self,
        report_at: SessionTime,
        part: &CommandPart<'_>,
    ) -> Option<(Terms, Vec<u8>)> {
        let CommandPart { id, length, offset, bytes } = *part;
        let command = self.find(id, length);
        if command.reports_left == 0 {
            command.report_at = report_at;
        }
        command.reports_left = REPORT_SENDS;
        if command.body.is_none() {
            command.body = command.parts.add(0, length, offset, bytes);
        }
        self.take_whole(id)
    }

    /// Takes the terms of a command; returns its body if it is whole.
    pub(super) fn take_head(
        &mut self,
        now: SessionTime,
        id: CommandId,
        length: u32,
        terms: Terms,
    ) -> Option<Vec<u8>> {
        let command = self.find(id, length);
        (command.terms, command.report_at) = (Some(terms), now);
        command.reports_left = REPORT_SENDS;
        self.take_whole(id).map(|(_, body)| body)
    }

    /// When the next report is due.
    pub(super) fn due_at(&self) -> Option<SessionTime> {
        let due = self.0.iter().filter(|command| command.reports_left > 0);
        due.map(|command| command.report_at).min()
    }

    /// Writes the reports that are due, as far as they fit. Each is sent again after `repeat_after`.
    pub(super) fn write(
        &mut self,
        now: SessionTime,
        repeat_after: Duration,
        payload: &mut PayloadWriter,
    ) {
        let is_due = |it: &&mut Incomplete| it.reports_left > 0 && it.report_at <= now;
        for command in self.0.iter_mut().filter(is_due) {
            if !payload.try_frame(&Frame::PartsHere(command.here())) {
                break;
            }
            command.reports_left -= 1;
            command.report_at = now + repeat_after;
        }
    }

    fn find(&mut self, id: CommandId, length: u32) -> &mut Incomplete {
        let is_it = |command: &Incomplete| (command.id, command.length) == (id, length);
        let place = self.0.iter().position(is_it).unwrap_or_else(|| {
            if self.0.len() >= INCOMPLETE_MAX {
                self.0.pop_front();
            }
            self.0.push_back(Incomplete::new(id, length));
            self.0.len() - 1
        });
        &mut self.0[place]
    }

    /// Removes the command if all of it is here.
    fn take_whole(&mut self, id: CommandId) -> Option<(Terms, Vec<u8>)> {
        let is_whole = |it: &Incomplete| it.id == id && it.terms.is_some() && it.body.is_some();
        let place = self.0.iter().position(is_whole)?;
        let command = self.0.remove(place)?;
        command.terms.zip(command.body)
    }
}

impl Incomplete {
    fn new(id: CommandId, length: u32) -> Self {
        Self {
            id,
            length,
            parts: Assembly::default(),
            body: None,
            terms: None,
            reports_left: 0,
            report_at: SessionTime::BEGIN,
        }
    }

    fn here(&self) -> PartsHere {
        let bytes = match self.body {
            Some(_) => RangeSet::up_to(u64::from(self.length)),
            None => self.parts.here().clone(),
        };
        PartsHere { id: self.id, has_head: self.terms.is_some(), bytes }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seal::Generation;

    const TERMS: Terms =
        Terms { robot_start: Generation(1), not_after_ms: 9, not_before_ms: 0, epoch: 0 };

    fn part(id: u8, offset: u32) -> CommandPart<'static> {
        CommandPart { id: CommandId([id; 16]), length: 4, offset, bytes: b"ab" }
    }

    #[test]
    fn a_command_is_whole_with_its_head_and_all_parts_in_any_order() {
        let (id, now) = (CommandId([1; 16]), SessionTime::BEGIN);
        for head_at in 0..3 {
            let mut commands = IncompleteCommands::default();
            let mut whole = Vec::new();
            for step in 0..3 {
                if step == head_at {
                    whole.extend(commands.take_head(now, id, 4, TERMS));
                } else {
                    let nth = step - u32::from(step > head_at);
                    let taken = commands.take_part(now, &part(1, nth * 2));
                    whole.extend(taken.map(|(_, body)| body));
                }
            }
            assert_eq!(whole, [b"abab"]);
            assert_eq!(commands.due_at(), None);
        }
    }

    #[test]
    fn of_more_commands_than_the_bound_the_oldest_is_dropped_and_comes_again() {
        let now = SessionTime::BEGIN;
        let mut commands = IncompleteCommands::default();
        for id in 0..=u8::try_from(INCOMPLETE_MAX).unwrap() {
            assert!(commands.take_part(now, &part(id, 0)).is_none());
            assert!(commands.take_head(now, CommandId([id; 16]), 4, TERMS).is_none());
        }
        // The first part of the oldest is dropped, that of the second is kept.
        assert!(commands.take_part(now, &part(1, 2)).is_some());
        assert!(commands.take_part(now, &part(0, 2)).is_none());
        assert!(commands.take_part(now, &part(0, 0)).is_none());
        assert!(commands.take_head(now, CommandId([0; 16]), 4, TERMS).is_some());
    }

    #[test]
    fn what_is_here_is_reported_twice() {
        let mut commands = IncompleteCommands::default();
        let (at, again) = (SessionTime::from_millis(10), Duration::from_millis(50));
        assert!(commands.take_part(at, &part(1, 2)).is_none());
        let mut payload = PayloadWriter::new(at, 1_000);
        commands.write(SessionTime::BEGIN, again, &mut payload);
        assert_eq!((payload.is_empty(), commands.due_at()), (true, Some(at)));
        commands.write(at, again, &mut payload);
        assert_eq!(commands.due_at(), Some(at + again));
        commands.write(at + again, again, &mut payload);
        assert_eq!((payload.frames().len(), commands.due_at()), (2, None));
    }
}
