//! State of the link to one robot at its station.

use crate::contacts::KnownContacts;
use crate::meter::{LinkMeter, millis};
use rafcon_link::{SessionTime, StationSession, StreamId};
use rafcon_protocol::{ClockOffset, LinkHealth, LinkRun};
use rafcon_supervisor::clock;

/// State of the link, without the counts of events and commands.
pub(super) fn health(
    meter: &mut LinkMeter,
    session: &StationSession,
    contacts: &KnownContacts,
    now: SessionTime,
) -> LinkHealth {
    let today = clock::since_1970_ms();
    let (sent, received) = session.traffic();
    let offset = |robot_ms: u64| robot_ms.cast_signed() - today.cast_signed();
    let clock = session
        .robot_calendar(now)
        .map(|(least, most)| ClockOffset { least_ms: offset(least), most_ms: most.map(offset) });
    let reached = session.reached_before(now);
    LinkHealth {
        reached_ms: reached.map(|before| today.saturating_sub(millis(before))),
        round_trip_ms: session.round_trip().map(millis),
        lifetime_ms: Some(millis(session.command_lifetime(now))),
        command_bytes_per_s: Some(session.command_bytes_per_s()),
        contact: contacts.current(today).cloned(),
        contacts_problem: contacts.problem.clone(),
        clock,
        ..meter.health(now, sent, received, session.heard_before(now))
    }
}

/// State of a run at the station.
pub(super) fn run_of(session: &StationSession, stream: StreamId, id: &str) -> LinkRun {
    let progress = session.progress(stream);
    let (head, missing) = progress.map_or((0, 0), |it| (it.head, it.head.saturating_sub(it.count)));
    LinkRun { id: id.to_owned(), head, missing }
}
