//! A client that follows a run from its cursor, over whatever happens to the server, and commands at random. Knows what it was
//! told, but not what was killed, unless it is the one that kills.

use super::site::{Site, Victim, now_ms};
use crate::served::Line;
use crate::torture::{Dice, tremble};
use rafcon_protocol::api::{CommandAnswer, HistoryEntry, LinkState, Refusal, RunNow};
use rafcon_protocol::socket::{ToClient, ToServer, Topic};
use rafcon_protocol::{
    Answer, Breakpoint, Command, Envelope, Expiry, RunStatus, Scope, Unattended, When,
};
use std::collections::{BTreeMap, VecDeque};
use std::fmt;

const HISTORY: u32 = 1;
const STATUS: u32 = 2;
/// How many commands of a client may be under way.
const UNDER_WAY_MAX: usize = 4;
/// How many commands a client invents, beside those that let the run continue.
const COMMANDS_MAX: u32 = 60;
/// How often a killing hand trembles at most.
const TREMBLES: u64 = 300_000;
/// What lets a run continue.
const RESUME: Command = Command::Resume { branch: None };
/// States of the machine that a breakpoint can stand at.
const STATES: [&str; 5] =
    ["ROOT/COUNTX", "ROOT/FORKED", "ROOT/RECOVR", "ROOT/FORKED/LEFTXX", "ROOT/FORKED/RIGHTX"];

/// When a client kills what.
#[derive(Debug, Clone, Copy)]
pub(super) struct Kill {
    /// After so many events more.
    pub(super) after: u64,
    /// And then right after it has sent its next command.
    pub(super) with_command: bool,
    pub(super) victim: Victim,
    /// The next runner is killed as well, after trembling so often.
    pub(super) again: Option<u64>,
}

/// Someone who follows and commands.
#[derive(Debug)]
pub(super) struct Client<'s, 'p> {
    site: &'s Site<'p>,
    name: &'static str,
    values: bool,
    dice: Dice,
    kills: VecDeque<Kill>,
    /// Events since the last kill.
    since: u64,
    /// The first event that it has not been told.
    next: u64,
    invented: u32,
    status: Option<Box<RunNow>>,
    under_way: BTreeMap<String, Envelope>,
    /// Not asked while the link between server and runner is down.
    again: bool,
    seen: Seen,
}

/// What a client knows in the end.
#[derive(Default)]
pub(super) struct Seen {
    pub(super) told: Vec<HistoryEntry>,
    pub(super) answers: BTreeMap<String, Answer>,
    /// Every command that it ever sent.
    pub(super) sent: BTreeMap<String, Envelope>,
    /// How many it killed.
    pub(super) killed: u64,
}

impl fmt::Debug for Seen {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let last = &self.told[self.told.len().saturating_sub(8)..];
        f.debug_struct("Seen")
            .field("last", &last)
            .field("answers", &self.answers.len())
            .finish_non_exhaustive()
    }
}

/// What comes of a connection.
#[derive(Debug, PartialEq, Eq)]
enum Then {
    GoOn,
    /// Everything has been told.
    Over,
}

impl<'s, 'p> Client<'s, 'p> {
    pub(super) fn new(site: &'s Site<'p>, name: &'static str, values: bool, dice: Dice) -> Self {
        Self {
            site,
            name,
            values,
            dice,
            kills: VecDeque::new(),
            since: 0,
            next: 1,
            invented: 0,
            status: None,
            under_way: BTreeMap::new(),
            again: false,
            seen: Seen::default(),
        }
    }

    pub(super) fn with_kills(self, kills: Vec<Kill>) -> Self {
        Self { kills: kills.into(), ..self }
    }

    /// Follows to the end.
    pub(super) fn follow(mut self) -> Seen {
        loop {
            let (door, generation) = self.site.door();
            let lost = match door.line() {
                Ok(mut line) => match self.talk(&mut line) {
                    Ok(()) => return self.seen,
                    Err(error) => error,
                },
                Err(error) => error,
            };
            // Whoever kills holds the site until the next server listens.
            let (_, now) = self.site.door();
            assert_ne!(
                now, generation,
                "{}: {lost:#}, though the server lives; {self:#?}",
                self.name
            );
        }
    }

    /// One connection, to its end or the run's.
    fn talk(&mut self, line: &mut Line) -> anyhow::Result<()> {
        let run = self.site.run.clone();
        let topic = Topic::RunHistory { run: run.clone(), from: self.next, values: self.values };
        line.say(&ToServer::Subscribe { subscription: HISTORY, topic })?;
        line.say(&ToServer::Subscribe { subscription: STATUS, topic: Topic::RunStatus { run } })?;
        self.say_again(line)?;
        loop {
            let text = line.hear_text()?;
            let frame: ToClient =
                serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error}: {text}"));
            if self.hear(line, frame)? == Then::Over {
                return Ok(());
            }
        }
    }

    fn hear(&mut self, line: &mut Line, frame: ToClient) -> anyhow::Result<Then> {
        match frame {
            ToClient::Events { subscription: HISTORY, next, events } => {
                self.told(next, events);
                self.meddle(line)?;
            }
            ToClient::RunStatus { subscription: STATUS, status } => {
                self.status = Some(status);
                if self.again && self.is_up() {
                    self.say_again(line)?;
                }
                self.let_go(line)?;
            }
            ToClient::Answer(CommandAnswer { id, answer }) => {
                self.answered(&id, &answer);
                self.go_on_after(line, &id, &answer)?;
            }
            ToClient::Refused { id: Some(id), refusal } => self.refused(line, &id, &refusal)?,
            ToClient::Ended { subscription: HISTORY, refusal: None } => return Ok(Then::Over),
            ToClient::Ended { subscription: STATUS, refusal: None } => {}
            other => panic!("{}: {other:?}", self.name),
        }
        Ok(Then::GoOn)
    }

    fn told(&mut self, next: u64, events: Vec<HistoryEntry>) {
        for entry in events {
            assert!(entry.sequence >= self.next, "{}: told twice: {entry:?}", self.name);
            self.next = entry.sequence + 1;
            self.since += 1;
            self.seen.told.push(entry);
        }
        assert!(next >= self.next, "{}: the cursor goes back to {next}", self.name);
        self.next = next;
    }

    fn answered(&mut self, id: &str, answer: &Answer) {
        self.under_way.remove(id);
        let first = self.seen.answers.entry(id.to_owned()).or_insert_with(|| answer.clone());
        assert_eq!(first, answer, "{}: {id} was answered otherwise before", self.name);
    }

    /// While the server has no link to the runner a command is asked again, by the same id.
    fn refused(&mut self, line: &mut Line, id: &str, refusal: &Refusal) -> anyhow::Result<()> {
        match refusal.code.as_str() {
            "link_lost" | "no_answer" if self.is_up() => return self.say_again(line),
            "link_lost" | "no_answer" => self.again = true,
            // It has ended, or no one has taken it up yet.
            "run_is_not_live" => drop(self.under_way.remove(id)),
            _ => panic!("{}: {id} was refused: {refusal:?}", self.name),
        }
        Ok(())
    }

    fn is_up(&self) -> bool {
        self.status.as_ref().is_some_and(|status| status.link == LinkState::Up)
    }

    fn say_again(&mut self, line: &mut Line) -> anyhow::Result<()> {
        self.again = false;
        for envelope in self.under_way.values().cloned() {
            line.say(&ToServer::Command { run: self.site.run.clone(), envelope })?;
        }
        Ok(())
    }

    /// Kills and commands as the dice fall.
    fn meddle(&mut self, line: &mut Line) -> anyhow::Result<()> {
        let due = self.kills.front().copied().filter(|kill| self.since >= kill.after);
        let wants = self.invented < COMMANDS_MAX && self.under_way.len() < UNDER_WAY_MAX;
        if wants && (due.is_some_and(|kill| kill.with_command) || self.dice.roll(3) == 0) {
            self.invented += 1;
            let command = self.invent();
            let expiry = self.expiry();
            self.command(line, command, expiry)?;
        } else if wants && self.dice.roll(4) == 0 {
            self.repeat(line)?;
        }
        if let Some(kill) = due {
            self.kill(kill);
        }
        Ok(())
    }

    fn kill(&mut self, kill: Kill) {
        tremble(self.dice.roll(TREMBLES));
        if self.site.kill(kill.victim, kill.again) {
            self.kills.pop_front();
            self.since = 0;
            self.seen.killed += 1;
        }
    }

    fn command(
        &mut self,
        line: &mut Line,
        command: Command,
        expiry: Option<Expiry>,
    ) -> anyhow::Result<()> {
        let id = format!("{}-{}", self.name, self.seen.sent.len());
        let decided_on = Some(self.next - 1);
        let envelope = Envelope { decided_on, expiry, ..Envelope::new(id.clone(), "", command) };
        self.seen.sent.insert(id.clone(), envelope.clone());
        self.under_way.insert(id, envelope.clone());
        line.say(&ToServer::Command { run: self.site.run.clone(), envelope })
    }

    /// Asks for something again that was answered: it must not be carried out again.
    fn repeat(&mut self, line: &mut Line) -> anyhow::Result<()> {
        let ids: Vec<_> = self.seen.answers.keys().cloned().collect();
        if ids.is_empty() {
            return Ok(());
        }
        let id = &ids[self.roll_index(ids.len())];
        let envelope = self.seen.sent[id].clone();
        self.under_way.insert(id.clone(), envelope.clone());
        line.say(&ToServer::Command { run: self.site.run.clone(), envelope })
    }

    /// A run that does not resume is not held any more, and its status is about to say so.
    fn go_on_after(&mut self, line: &mut Line, id: &str, answer: &Answer) -> anyhow::Result<()> {
        let is_refused = matches!(answer, Answer::Refused { .. });
        let resumes = matches!(self.seen.sent[id].command, Command::Resume { .. });
        if !is_refused {
            return self.let_go(line);
        }
        if resumes || !self.is_held() {
            return Ok(());
        }
        self.command(line, RESUME, None)
    }

    fn is_held(&self) -> bool {
        self.status.as_deref().is_some_and(is_held) && self.under_way.len() < UNDER_WAY_MAX
    }

    /// A run that is held continues, at once or step by step.
    fn let_go(&mut self, line: &mut Line) -> anyhow::Result<()> {
        if !self.is_held() {
            return Ok(());
        }
        let command = match self.dice.roll(6) {
            0 => Command::StepInto { branch: None },
            1 => Command::StepOver { branch: None },
            2 => Command::StepOut { branch: None },
            _ => RESUME,
        };
        self.command(line, command, None)
    }

    fn invent(&mut self) -> Command {
        match self.dice.roll(9) {
            0 | 1 => Command::Pause,
            2 => RESUME,
            3 => Command::StepMode,
            4 => Command::StepOver { branch: None },
            5 => Command::RemoveBreakpoint { id: self.dice.roll(3) },
            6 => Command::EditScript { path: "ROOT/RECOVR".to_owned(), script: self.script() },
            _ => Command::SetBreakpoint { breakpoint: self.breakpoint() },
        }
    }

    fn breakpoint(&mut self) -> Breakpoint {
        let path = STATES[self.roll_index(STATES.len())].to_owned();
        Breakpoint {
            id: self.dice.roll(3),
            path,
            when: When::default(),
            condition: None,
            hit_count: u32::try_from(self.dice.roll(20)).unwrap(),
            scope: Scope::default(),
            unattended: Unattended::default(),
            lost_link_ms: None,
            enabled: true,
        }
    }

    /// Another text that does the same.
    fn script(&self) -> String {
        let text = "def execute(self, inputs, outputs, gvm):\n    return 0\n";
        format!("# {} {}\n{text}", self.name, self.invented)
    }

    /// None, long, short, or over already.
    fn expiry(&mut self) -> Option<Expiry> {
        let ms = match self.dice.roll(8) {
            0..=2 => return None,
            3 => 60_000,
            4 => 200,
            5 | 6 => self.dice.roll(40),
            _ => return Some(Expiry(now_ms() - 1)),
        };
        Some(Expiry(now_ms() + ms))
    }

    fn roll_index(&mut self, length: usize) -> usize {
        usize::try_from(self.dice.roll(length as u64)).unwrap()
    }
}

/// Whether someone has to let the run continue.
fn is_held(status: &RunNow) -> bool {
    let Some(snapshot) = status.snapshot.as_ref().filter(|_| status.link == LinkState::Up) else {
        return false;
    };
    let stands = matches!(snapshot.status, RunStatus::Paused | RunStatus::Stepping);
    stands || snapshot.active.iter().any(|active| !active.held.is_empty())
}
