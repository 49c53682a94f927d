//! Who commands a run: one user at a time, who may be asked for it, hand it over, or lose it by silence. Pure: the time comes
//! in. Knows users by their names; must never know what they command.

use rafcon_protocol::api::{Control, ControlMove};
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// So many ask at a time.
const REQUESTS_MAX: usize = 64;

/// Who holds control of a run, and who asks for it. Nobody asks while nobody holds it.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub(super) struct Holding {
    holder: Option<Holder>,
    requests: Vec<String>,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct Holder {
    user: String,
    since_ms: u64,
    /// Not kept: whoever held a run when the server went away has all the time again.
    #[serde(skip)]
    heard_ms: u64,
}

/// Why control does not change hands, or a command is not for this user.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub(super) enum Denied {
    /// Somebody else holds it.
    #[error(
        "{holder} holds control of this run: request it (POST …/control with \"move\": \"request\"), or take it over \
         when they have been silent for {silence_s} s; stop and pause need no control"
    )]
    Held {
        /// Who.
        holder: String,
        /// After how many seconds of silence it can be taken over.
        silence_s: u64,
    },
    /// The holder was heard.
    #[error(
        "{holder} was heard {heard_s} s ago: control can be taken over after {silence_s} s of silence; request it meanwhile"
    )]
    Heard {
        /// Who holds it.
        holder: String,
        /// How long ago.
        heard_s: u64,
        /// After how many seconds of silence it can be taken over.
        silence_s: u64,
    },
    /// Only the holder can do this, and nobody is.
    #[error(
        "nobody holds control of this run: the first who commands takes it, or who requests it"
    )]
    Nobody,
    /// Nobody can be called that.
    #[error("control is handed over to a user: a name of 1 to 64 characters")]
    NoName,
    /// There is a limit.
    #[error(
        "{REQUESTS_MAX} users ask for control of this run already: wait until some of them have withdrawn"
    )]
    TooMany,
}

impl Holding {
    /// What was kept, by whoever looks after the run from `now_ms` on.
    pub(super) fn go_on(mut self, now_ms: u64) -> Self {
        if let Some(holder) = &mut self.holder {
            holder.heard_ms = now_ms;
        }
        self
    }

    /// The user who holds it.
    pub(super) fn holder(&self) -> Option<&str> {
        self.holder.as_ref().map(|holder| holder.user.as_str())
    }

    /// How it is told.
    pub(super) fn told(&self, silence: Duration) -> Control {
        let holder = self.holder.as_ref();
        Control {
            holder: holder.map(|holder| holder.user.clone()),
            since_ms: holder.map_or(0, |holder| holder.since_ms),
            heard_ms: holder.map_or(0, |holder| holder.heard_ms),
            silence_ms: millis(silence),
            requests: self.requests.clone(),
        }
    }

    /// Somebody was heard; true if it is the holder.
    pub(super) fn heard(&mut self, user: &str, now_ms: u64) -> bool {
        match &mut self.holder {
            Some(holder) if holder.user == user => {
                holder.heard_ms = holder.heard_ms.max(now_ms);
                true
            }
            _ => false,
        }
    }

    /// Somebody commands: the first takes control, all but the holder are denied. Who commands what everybody may is not asked.
    pub(super) fn command(
        &mut self,
        user: &str,
        now_ms: u64,
        silence: Duration,
    ) -> Result<(), Denied> {
        if self.heard(user, now_ms) {
            return Ok(());
        }
        match &self.holder {
            None => self.give(user, now_ms),
            Some(holder) => return Err(holder.denies(silence)),
        }
        Ok(())
    }

    /// Somebody wants something about control.
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
            ControlMove::Withdraw => self.requests.retain(|other| other != user),
            ControlMove::HandOver { to } => {
                self.own(user, silence)?;
                if to.is_empty() || to.chars().count() > 64 {
                    return Err(Denied::NoName);
                }
                self.give(to, now_ms);
            }
            ControlMove::Release => {
                self.own(user, silence)?;
                self.let_go(now_ms);
            }
            ControlMove::TakeOver => self.take_over(user, now_ms, silence)?,
        }
        Ok(())
    }

    fn request(&mut self, user: &str, now_ms: u64) -> Result<(), Denied> {
        let Some(holder) = &self.holder else {
            self.give(user, now_ms);
            return Ok(());
        };
        if holder.user == user || self.requests.iter().any(|other| other == user) {
            return Ok(());
        }
        if self.requests.len() >= REQUESTS_MAX {
            return Err(Denied::TooMany);
        }
        self.requests.push(user.to_owned());
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

    /// Whether it is this user who holds it.
    fn own(&self, user: &str, silence: Duration) -> Result<(), Denied> {
        match &self.holder {
            None => Err(Denied::Nobody),
            Some(holder) if holder.user == user => Ok(()),
            Some(holder) => Err(holder.denies(silence)),
        }
    }

    /// Who asked first gets it, if anybody did.
    fn let_go(&mut self, now_ms: u64) {
        self.holder = None;
        if !self.requests.is_empty() {
            let first = self.requests.remove(0);
            self.give(&first, now_ms);
        }
    }

    fn give(&mut self, user: &str, now_ms: u64) {
        self.requests.retain(|other| other != user);
        if self.holder() != Some(user) {
            self.holder =
                Some(Holder { user: user.to_owned(), since_ms: now_ms, heard_ms: now_ms });
        }
    }
}

impl Holder {
    fn denies(&self, silence: Duration) -> Denied {
        Denied::Held { holder: self.user.clone(), silence_s: silence.as_secs() }
    }
}

fn millis(time: Duration) -> u64 {
    u64::try_from(time.as_millis()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::Holding;
    use expect_test::{Expect, expect};
    use proptest::prelude::*;
    use rafcon_protocol::api::ControlMove;
    use std::fmt::Write as _;
    use std::time::Duration;

    const SILENCE: Duration = Duration::from_secs(30);

    fn wanted(word: &str) -> Option<ControlMove> {
        Some(match word {
            "requests" => ControlMove::Request,
            "withdraws" => ControlMove::Withdraw,
            "hands-to-cy" => ControlMove::HandOver { to: "cy".to_owned() },
            "releases" => ControlMove::Release,
            "takes-over" => ControlMove::TakeOver,
            _ => return None,
        })
    }

    /// Lines of `second user what`; `commands` is a command.
    fn play(holding: &mut Holding, line: &str) -> Result<(), super::Denied> {
        let words: Vec<&str> = line.split_whitespace().collect();
        let [second, user, what] = words[..] else { panic!("{line}") };
        let now_ms = second.parse::<u64>().unwrap() * 1000;
        match wanted(what) {
            Some(wanted) => holding.apply(user, &wanted, now_ms, SILENCE),
            None if what == "commands" => holding.command(user, now_ms, SILENCE),
            None => {
                holding.heard(user, now_ms);
                Ok(())
            }
        }
    }

    fn shown(holding: &Holding) -> String {
        let control = holding.told(SILENCE);
        format!("{} {:?}", control.holder.as_deref().unwrap_or("nobody"), control.requests)
    }

    fn check(script: &str, expect: &Expect) {
        let mut holding = Holding::default();
        let mut seen = String::new();
        for line in script.lines().map(str::trim).filter(|line| !line.is_empty()) {
            let answer = play(&mut holding, line);
            let answer = answer.map_or_else(|denied| format!(": {denied}"), |()| String::new());
            writeln!(seen, "{line} -> {}{answer}", shown(&holding)).unwrap();
        }
        expect.assert_eq(&seen);
    }

    /// Every move in every situation: what becomes of it.
    #[test]
    fn every_move_has_an_answer_in_every_situation() {
        let situations = [
            ("nobody", ""),
            ("ana", "0 ana commands"),
            ("ana, bob asks", "0 ana commands; 1 bob requests"),
            ("bob", "0 bob commands"),
            ("bob, ana asks", "0 bob commands; 1 ana requests"),
            ("bob, cy asks", "0 bob commands; 1 cy requests"),
        ];
        let mut table = String::new();
        for (name, before) in situations {
            for (second, silent) in [(10, ""), (40, ", long ago")] {
                let what =
                    ["commands", "requests", "withdraws", "hands-to-cy", "releases", "takes-over"];
                for what in what {
                    let mut holding = after(before);
                    let answer = play(&mut holding, &format!("{second} ana {what}"));
                    let answer = answer.map_or_else(|denied| denied_as(&denied), |()| "");
                    let told = shown(&holding);
                    writeln!(table, "{name}{silent} | ana {what} | {told}{answer}").unwrap();
                }
            }
        }
        expect![[r#"
            nobody | ana commands | ana []
            nobody | ana requests | ana []
            nobody | ana withdraws | nobody []
            nobody | ana hands-to-cy | nobody [], denied: nobody holds it
            nobody | ana releases | nobody [], denied: nobody holds it
            nobody | ana takes-over | ana []
            nobody, long ago | ana commands | ana []
            nobody, long ago | ana requests | ana []
            nobody, long ago | ana withdraws | nobody []
            nobody, long ago | ana hands-to-cy | nobody [], denied: nobody holds it
            nobody, long ago | ana releases | nobody [], denied: nobody holds it
            nobody, long ago | ana takes-over | ana []
            ana | ana commands | ana []
            ana | ana requests | ana []
            ana | ana withdraws | ana []
            ana | ana hands-to-cy | cy []
            ana | ana releases | nobody []
            ana | ana takes-over | ana []
            ana, long ago | ana commands | ana []
            ana, long ago | ana requests | ana []
            ana, long ago | ana withdraws | ana []
            ana, long ago | ana hands-to-cy | cy []
            ana, long ago | ana releases | nobody []
            ana, long ago | ana takes-over | ana []
            ana, bob asks | ana commands | ana ["bob"]
            ana, bob asks | ana requests | ana ["bob"]
            ana, bob asks | ana withdraws | ana ["bob"]
            ana, bob asks | ana hands-to-cy | cy ["bob"]
            ana, bob asks | ana releases | bob []
            ana, bob asks | ana takes-over | ana ["bob"]
            ana, bob asks, long ago | ana commands | ana ["bob"]
            ana, bob asks, long ago | ana requests | ana ["bob"]
            ana, bob asks, long ago | ana withdraws | ana ["bob"]
            ana, bob asks, long ago | ana hands-to-cy | cy ["bob"]
            ana, bob asks, long ago | ana releases | bob []
            ana, bob asks, long ago | ana takes-over | ana ["bob"]
            bob | ana commands | bob [], denied: held
            bob | ana requests | bob ["ana"]
            bob | ana withdraws | bob []
            bob | ana hands-to-cy | bob [], denied: held
            bob | ana releases | bob [], denied: held
            bob | ana takes-over | bob [], denied: heard
            bob, long ago | ana commands | bob [], denied: held
            bob, long ago | ana requests | bob ["ana"]
            bob, long ago | ana withdraws | bob []
            bob, long ago | ana hands-to-cy | bob [], denied: held
            bob, long ago | ana releases | bob [], denied: held
            bob, long ago | ana takes-over | ana []
            bob, ana asks | ana commands | bob ["ana"], denied: held
            bob, ana asks | ana requests | bob ["ana"]
            bob, ana asks | ana withdraws | bob []
            bob, ana asks | ana hands-to-cy | bob ["ana"], denied: held
            bob, ana asks | ana releases | bob ["ana"], denied: held
            bob, ana asks | ana takes-over | bob ["ana"], denied: heard
            bob, ana asks, long ago | ana commands | bob ["ana"], denied: held
            bob, ana asks, long ago | ana requests | bob ["ana"]
            bob, ana asks, long ago | ana withdraws | bob []
            bob, ana asks, long ago | ana hands-to-cy | bob ["ana"], denied: held
            bob, ana asks, long ago | ana releases | bob ["ana"], denied: held
            bob, ana asks, long ago | ana takes-over | ana []
            bob, cy asks | ana commands | bob ["cy"], denied: held
            bob, cy asks | ana requests | bob ["cy", "ana"]
            bob, cy asks | ana withdraws | bob ["cy"]
            bob, cy asks | ana hands-to-cy | bob ["cy"], denied: held
            bob, cy asks | ana releases | bob ["cy"], denied: held
            bob, cy asks | ana takes-over | bob ["cy"], denied: heard
            bob, cy asks, long ago | ana commands | bob ["cy"], denied: held
            bob, cy asks, long ago | ana requests | bob ["cy", "ana"]
            bob, cy asks, long ago | ana withdraws | bob ["cy"]
            bob, cy asks, long ago | ana hands-to-cy | bob ["cy"], denied: held
            bob, cy asks, long ago | ana releases | bob ["cy"], denied: held
            bob, cy asks, long ago | ana takes-over | ana ["cy"]
        "#]]
        .assert_eq(&table);
    }

    /// After these lines, with a semicolon between each.
    fn after(lines: &str) -> Holding {
        let mut holding = Holding::default();
        let lines = lines.split(';').filter(|line| !line.is_empty());
        lines.for_each(|line| play(&mut holding, line).unwrap());
        holding
    }

    fn denied_as(denied: &super::Denied) -> &'static str {
        match denied {
            super::Denied::Held { .. } => ", denied: held",
            super::Denied::Heard { .. } => ", denied: heard",
            super::Denied::Nobody => ", denied: nobody holds it",
            super::Denied::NoName => ", denied: no name",
            super::Denied::TooMany => ", denied: too many",
        }
    }

    #[test]
    fn control_changes_hands() {
        check(
            "0 ana commands
             1 bob commands
             2 bob requests
             3 ana hands-to-cy
             4 cy releases
             5 bob takes-over
             20 bob heard
             40 ana takes-over
             50 ana takes-over",
            &expect![[r#"
                0 ana commands -> ana []
                1 bob commands -> ana []: ana holds control of this run: request it (POST …/control with "move": "request"), or take it over when they have been silent for 30 s; stop and pause need no control
                2 bob requests -> ana ["bob"]
                3 ana hands-to-cy -> cy ["bob"]
                4 cy releases -> bob []
                5 bob takes-over -> bob []
                20 bob heard -> bob []
                40 ana takes-over -> bob []: bob was heard 20 s ago: control can be taken over after 30 s of silence; request it meanwhile
                50 ana takes-over -> ana []
            "#]],
        );
    }

    proptest! {
        /// Whoever does what when: nobody loses control who was heard in time and did not give it away.
        #[test]
        fn control_is_only_lost_by_silence(moves in prop::collection::vec((0..3_usize, 0..7_usize, 0..20_u64), 0..60)) {
            let words = ["commands", "requests", "withdraws", "hands-to-cy", "releases", "takes-over", "heard"];
            let users = ["ana", "bob", "cy"];
            let (mut holding, mut now, mut heard) = (Holding::default(), 0, 0);
            for (user, word, later) in moves {
                now += later;
                let before = holding.holder().map(str::to_owned);
                let answer = play(&mut holding, &format!("{now} {} {}", users[user], words[word]));
                let after = holding.holder().map(str::to_owned);
                if before.is_some() && before != after {
                    let given = before.as_deref() == Some(users[user]);
                    prop_assert!(answer.is_ok() && (given || now - heard >= 30));
                }
                if after.as_deref() == Some(users[user]) || before != after {
                    heard = now;
                }
                prop_assert!(after.is_some() || holding.requests.is_empty());
            }
        }
    }
}
