//! The contact with the ground: the times of its last message and last command, and the silence reported to policies of
//! states, breakpoints and questions (`docs/semantics.md`, Lost link). The process that carries the run to the ground
//! reports each message. If that process dies, the ground is silent, too.

use crate::drive::record_events::ExtraRecords;
use crate::record::tell;
use crate::{Driver, Scripts};
use rafcon_engine::{Input, Silence};
use rafcon_locks::Mutex;
use rafcon_protocol::Event;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

const MS: u64 = 1_000_000;

/// The state of the contact with the ground.
#[derive(Debug, Default)]
pub(crate) struct Ground {
    /// Locked while the silence is passed to the engine, so that the engine's latest value is correct.
    contact: Mutex<Option<Contact>>,
    /// Time of the last urgent command, by the run's clock.
    urgent_ns: AtomicU64,
}

/// The ground of a run, with times of the run's clock.
#[derive(Debug)]
struct Contact {
    heard_ns: u64,
    commanded_ns: u64,
    /// The silence last passed to the engine.
    told: Silence,
}

impl Contact {
    /// The longest expired time of each list.
    fn silence(&self, now_ns: u64, times: &[Vec<u64>; 2]) -> Silence {
        let over = |since_ns: u64, times: &[u64]| {
            let silent_ms = now_ns.saturating_sub(since_ns) / MS;
            times.iter().copied().filter(|time| *time <= silent_ms).max().unwrap_or_default()
        };
        let [link, command] = times;
        Silence { link_ms: over(self.heard_ns, link), command_ms: over(self.commanded_ns, command) }
    }

    /// The next time at which a silence expires.
    fn next_ns(&self, now_ns: u64, times: &[Vec<u64>; 2]) -> Option<u64> {
        let [link, command] = times;
        let at = |since_ns: u64, time: &u64| since_ns.saturating_add(time.saturating_mul(MS));
        let links = link.iter().map(|time| at(self.heard_ns, time));
        let commands = command.iter().map(|time| at(self.commanded_ns, time));
        links.chain(commands).filter(|at_ns| *at_ns > now_ns).min()
    }
}

impl<S: Scripts> Driver<S> {
    /// Handles a report of the process that carries the run to the ground: the age of the ground's last message in ms,
    /// or `None` if it has received none yet.
    pub(crate) fn ground_heard(self: &Arc<Self>, heard_ms_ago: Option<u64>) {
        let now_ns = self.clock().now_ns();
        let heard_ns = heard_ms_ago.map(|ago| now_ns.saturating_sub(ago.saturating_mul(MS)));
        let mut ground = self.ground().contact.lock();
        let is_new = ground.is_none();
        let contact = ground.get_or_insert_with(|| Contact {
            heard_ns: heard_ns.unwrap_or(now_ns),
            commanded_ns: now_ns,
            told: Silence::default(),
        });
        contact.heard_ns = contact.heard_ns.max(heard_ns.unwrap_or_default());
        if is_new {
            self.record().tell(Event::Silence { link_ms: 0, command_ms: 0 });
        }
        self.tell_silence(contact);
    }

    /// Notes a command, which ends the silence.
    pub(crate) fn ground_commands(self: &Arc<Self>) {
        let now_ns = self.clock().now_ns();
        let mut ground = self.ground().contact.lock();
        if let Some(contact) = ground.as_mut() {
            (contact.heard_ns, contact.commanded_ns) = (now_ns, now_ns);
            self.tell_silence(contact);
        }
    }

    /// Notes an urgent command. The thread of the timers updates the engine.
    pub(crate) fn ground_commands_urgently(&self) {
        self.ground().urgent_ns.fetch_max(self.clock().now_ns(), Ordering::Relaxed);
        self.look_at_ground_later();
    }

    /// Restores the silence of a run whose last runner ended.
    pub(crate) fn ground_was(self: &Arc<Self>, told: Silence) {
        let now_ns = self.clock().now_ns();
        let since = |ms: u64| now_ns.saturating_sub(ms.saturating_mul(MS));
        let (heard_ns, commanded_ns) = (since(told.link_ms), since(told.command_ms));
        *self.ground().contact.lock() = Some(Contact { heard_ns, commanded_ns, told });
        // Legal in every status.
        drop(self.command(Input::Silence(told)));
        self.look_at_ground_later();
    }

    /// Checks whether the silence has reached a time that a policy, breakpoint or question names.
    pub(crate) fn look_at_ground(self: &Arc<Self>) {
        if let Some(contact) = self.ground().contact.lock().as_mut() {
            self.tell_silence(contact);
        }
    }

    /// Schedules [`Self::look_at_ground`] on the thread of the timers, because the named times may have changed.
    pub(crate) fn look_at_ground_later(&self) {
        self.timers().look_at_silence(Some(0));
    }

    fn tell_silence(self: &Arc<Self>, contact: &mut Contact) {
        let (now_ns, times) = (self.clock().now_ns(), self.silences());
        let urgent_ns = self.ground().urgent_ns.load(Ordering::Relaxed);
        contact.heard_ns = contact.heard_ns.max(urgent_ns);
        contact.commanded_ns = contact.commanded_ns.max(urgent_ns);
        let silence = contact.silence(now_ns, &times);
        self.timers().look_at_silence(contact.next_ns(now_ns, &times));
        if silence != contact.told {
            contact.told = silence;
            let Silence { link_ms, command_ms } = silence;
            let event = tell::told(Event::Silence { link_ms, command_ms });
            let beside = || ExtraRecords { first: Some(event), last: None };
            // Refused once the run is over, when it no longer matters.
            drop(self.input_beside(Input::Silence(silence), || false, beside));
        }
        // Questions close after the engine's update, because their scripts continue at once and must see the
        // silence.
        self.questions().give_up(silence.link_ms);
    }

    /// The times of silence that something names now: of the link, then of commands.
    fn silences(&self) -> [Vec<u64>; 2] {
        let [mut link, command] = self.timers().silences();
        link.extend(self.points().all().iter().filter_map(|point| point.lost_link_ms));
        link.extend(self.questions().silences());
        [link, command]
    }
}
