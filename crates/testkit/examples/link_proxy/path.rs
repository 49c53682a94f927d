//! Both directions of the bad path, and the words that change it: `cut`, `hold` and `mend`, for one direction with `down` or `up`
//! after them, `delay MS`, `down BITS`, `up BITS`, `lost PERCENT`, `doubled PERCENT`, `late PERCENT`, `flipped PERCENT`.

use rafcon_testkit::link_world::{Carrier, Conditions, Cut};
use std::time::Duration;

/// A path between a robot and a station.
pub(crate) struct BadPath {
    /// From the robot.
    pub(crate) down: Carrier,
    /// To the robot.
    pub(crate) up: Carrier,
}

impl BadPath {
    pub(crate) fn new(down: Conditions, up: Conditions) -> Self {
        Self { down: Carrier::new(down, 1), up: Carrier::new(up, 2) }
    }

    /// When the next datagram arrives at either end.
    pub(crate) fn next(&self) -> Option<Duration> {
        [self.down.next(), self.up.next()].into_iter().flatten().min()
    }

    /// Does what a line says, or tells why it is not understood.
    pub(crate) fn obey(&mut self, now: Duration, line: &str) -> Result<(), String> {
        let words: Vec<_> = line.split_whitespace().collect();
        let not_understood = || {
            format!(
                "`{line}` is not understood: say `cut`, `hold`, `mend`, `delay 2000`, `lost 2` …"
            )
        };
        match words[..] {
            [word] => {
                self.for_each("", |carrier| cut(carrier, now, word)).ok_or_else(not_understood)
            }
            [word @ ("cut" | "hold" | "mend"), way @ ("down" | "up")] => {
                self.for_each(way, |carrier| cut(carrier, now, word)).ok_or_else(not_understood)
            }
            [way @ ("down" | "up"), bits] => {
                let bits = number(bits)?;
                self.change(way, |conditions| conditions.bits_per_s = bits.max(1));
                Ok(())
            }
            [word, value] => {
                let value = number(value)?;
                self.set(word, value).ok_or_else(not_understood)
            }
            _ => Err(not_understood()),
        }
    }

    fn set(&mut self, word: &str, value: u64) -> Option<()> {
        let percent = usize::try_from(value.min(100)).ok()?;
        match word {
            "delay" => self.change("", |to| to.delay = Duration::from_millis(value)),
            "lost" => self.change("", |to| to.lost = percent),
            "doubled" => self.change("", |to| to.doubled = percent),
            "late" => self.change("", |to| to.late = percent),
            "flipped" => self.change("", |to| to.flipped = percent),
            _ => return None,
        }
        Some(())
    }

    fn change(&mut self, way: &str, change: impl Fn(&mut Conditions)) {
        let changed = self.for_each(way, |carrier| {
            let mut conditions = carrier.conditions().clone();
            change(&mut conditions);
            carrier.set_conditions(conditions);
            Some(())
        });
        changed.unwrap_or_default();
    }

    fn for_each(
        &mut self,
        way: &str,
        mut act: impl FnMut(&mut Carrier) -> Option<()>,
    ) -> Option<()> {
        let both = [("down", &mut self.down), ("up", &mut self.up)];
        both.into_iter()
            .filter(|(name, _)| way.is_empty() || *name == way)
            .try_for_each(|it| act(it.1))
    }

    /// How it is, as a line of JSON.
    pub(crate) fn say(&self, now: Duration) -> String {
        let [down, up] = [&self.down, &self.up].map(|carrier| {
            let Conditions { delay, bits_per_s, lost, doubled, late, .. } = carrier.conditions();
            let cut = match carrier.cut_at(now) {
                None => "null",
                Some(Cut::Drops) => "\"cut\"",
                Some(Cut::Holds) => "\"hold\"",
            };
            let (bytes, delay) = (carrier.bytes, delay.as_millis());
            format!(
                r#"{{"bytes": {bytes}, "cut": {cut}, "bits_per_s": {bits_per_s}, "delay_ms": {delay}, "lost": {lost}, "doubled": {doubled}, "late": {late}}}"#
            )
        });
        format!(r#"{{"now_ms": {}, "down": {down}, "up": {up}}}"#, now.as_millis())
    }
}

fn cut(carrier: &mut Carrier, now: Duration, word: &str) -> Option<()> {
    match word {
        "cut" => carrier.begin_cut(now, Cut::Drops),
        "hold" => carrier.begin_cut(now, Cut::Holds),
        "mend" => carrier.end_cut(now),
        _ => return None,
    }
    Some(())
}

fn number(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_none| format!("`{text}` is no number"))
}
