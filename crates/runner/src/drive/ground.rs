//! Whether anyone on the ground is there: when it was heard and gave a command last, and what policies of states, breakpoints and
//! questions are told of its silence (`docs/semantics.md`, Lost link). Whoever carries the run to the ground feeds this; if that
//! dies, the ground is silent, too.

use crate::drive::record_events::ExtraRecords;
use crate::record::tell;
use crate::{Driver, Scripts};
use rafcon_engine::{Input, Silence};
use rafcon_locks::Mutex;
use rafcon_protocol::Event;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

const MS: u64 = 1_000_000;

/// What is known of the ground.
#[derive(Debug, Default)]
pub(crate) struct Ground {
    /// Held while the engine is told, so that it is told last what is true.
    contact: Mutex<Option<Contact>>,
    /// When someone gave a command last that waits for nothing, by the run's clock.
    urgent_ns: AtomicU64,
}

/// A run that has a ground, by the run's clock.
#[derive(Debug)]
struct Contact {
    heard_ns: u64,
    commanded_ns: u64,
    /// What the engine knows.
    told: Silence,
}

impl Contact {
    /// The longest of the times that are over, of each list.
    fn silence(&self, now_ns: u64, times: &[Vec<u64>; 2]) -> Silence {
        let over = |since_ns: u64, times: &[u64]| {
            let silent_ms = now_ns.saturating_sub(since_ns) / MS;
            times.iter().copied().filter(|time| *time <= silent_ms).max().unwrap_or_default()
        };
        let [link, command] = times;
        Silence { link_ms: over(self.heard_ns, link), command_ms: over(self.commanded_ns, command) }
    }

    /// When the next time is over.
    fn next_ns(&self, now_ns: u64, times: &[Vec<u64>; 2]) -> Option<u64> {
        let [link, command] = times;
        let at = |since_ns: u64, time: &u64| since_ns.saturating_add(time.saturating_mul(MS));
        let links = link.iter().map(|time| at(self.heard_ns, time));
        let commands = command.iter().map(|time| at(self.commanded_ns, time));
        links.chain(commands).filter(|at_ns| *at_ns > now_ns).min()
    }
}

impl<S: Scripts> Driver<S> {
    /// Whoever carries the run to the ground heard it so many ms ago; or says that it carries the run, and has not heard it yet.
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

    /// Someone gives a command: whoever does is there.
    pub(crate) fn ground_commands(self: &Arc<Self>) {
        let now_ns = self.clock().now_ns();
        let mut ground = self.ground().contact.lock();
        if let Some(contact) = ground.as_mut() {
            (contact.heard_ns, contact.commanded_ns) = (now_ns, now_ns);
            self.tell_silence(contact);
        }
    }

    /// The same for a command that waits for nothing: the engine is told on the thread of the timers.
    pub(crate) fn ground_commands_urgently(&self) {
        self.ground().urgent_ns.fetch_max(self.clock().now_ns(), Ordering::Relaxed);
        self.look_at_ground_later();
    }

    /// The run had a ground that was silent for so long when its last runner ended.
    pub(crate) fn ground_was(self: &Arc<Self>, told: Silence) {
        let now_ns = self.clock().now_ns();
        let since = |ms: u64| now_ns.saturating_sub(ms.saturating_mul(MS));
        let (heard_ns, commanded_ns) = (since(told.link_ms), since(told.command_ms));
        *self.ground().contact.lock() = Some(Contact { heard_ns, commanded_ns, told });
        // Legal in every status.
        drop(self.command(Input::Silence(told)));
        self.look_at_ground_later();
    }

    /// Looks whether the ground has been silent for as long as something names.
    pub(crate) fn look_at_ground(self: &Arc<Self>) {
        if let Some(contact) = self.ground().contact.lock().as_mut() {
            self.tell_silence(contact);
        }
    }

    /// The same, on the thread of the timers: something names another time from now on.
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
            // Refused once the run is over, and then it makes no difference.
            drop(self.input_beside(Input::Silence(silence), || false, beside));
        }
        // Afterwards: who asked goes on at once, and what it does next is to know of the silence.
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
