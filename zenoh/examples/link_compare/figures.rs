//! What arrived when, and the table of it.

use crate::events::Events;
use std::fmt::Write as _;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Notes when each event arrives first.
#[derive(Debug)]
pub(crate) struct Recorder {
    begin: Instant,
    arrived: Mutex<Vec<Option<Duration>>>,
}

/// What one way did.
#[derive(Debug)]
pub(crate) struct Figures {
    lost: usize,
    live_s: Option<f64>,
    p50_s: f64,
    p99_s: f64,
    bytes: f64,
}

impl Recorder {
    pub(crate) fn new(begin: Instant, events: &Events) -> Self {
        Self { begin, arrived: Mutex::new(vec![None; events.list.len()]) }
    }

    /// An event arrived, perhaps again.
    pub(crate) fn note(&self, number: usize) {
        let mut arrived = self.arrived.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(arrived) = arrived.get_mut(number) {
            arrived.get_or_insert(self.begin.elapsed());
        }
    }

    /// So many bytes were sent before the cut.
    pub(crate) fn figures(
        &self,
        events: &Events,
        bytes: u64,
        (cut, returns): (Duration, Duration),
    ) -> Figures {
        let arrived = self.arrived.lock().unwrap_or_else(PoisonError::into_inner);
        let all = events.list.iter().map(|event| event.time).zip(arrived.iter().copied());
        let after = all.clone().filter(|(time, _)| *time >= returns);
        let live = after.filter_map(|(_, arrived)| arrived).min();
        // What is on its way when the link is cut is not outside of the cut.
        let is_outside =
            |time: Duration| time + Duration::from_millis(2_500) < cut || time >= returns;
        let outside = all.clone().filter(|(time, _)| is_outside(*time));
        // What is lost is later than all else.
        let late = outside.map(|(time, arrived)| {
            arrived.map_or(f64::INFINITY, |arrived| arrived.saturating_sub(time).as_secs_f64())
        });
        let mut late: Vec<f64> = late.collect();
        late.sort_by(f64::total_cmp);
        let part = |percent: usize| {
            let last = late.len().saturating_sub(1);
            late.get((late.len() * percent / 100).min(last)).copied().unwrap_or(f64::INFINITY)
        };
        let before = all.clone().filter(|(time, _)| *time < cut).count();
        Figures {
            lost: all.clone().filter(|(_, arrived)| arrived.is_none()).count(),
            live_s: live.map(|live| live.saturating_sub(returns).as_secs_f64()),
            p50_s: part(50),
            p99_s: part(99),
            bytes: bytes as f64 / before as f64,
        }
    }
}

/// For people.
pub(crate) fn table(rows: &[(&str, Figures)]) -> String {
    let seconds = |value: f64| match value.is_finite() {
        true => format!("{value:.2} s"),
        false => "never".to_owned(),
    };
    let mut text = "| | lost | live after return | p50 | p99 | bytes an event |\n".to_owned();
    text.push_str("| --- | --- | --- | --- | --- | --- |\n");
    for (name, Figures { lost, live_s, p50_s, p99_s, bytes }) in rows {
        let (live, p50, p99) =
            (seconds(live_s.unwrap_or(f64::INFINITY)), seconds(*p50_s), seconds(*p99_s));
        let row = format!("| {name} | {lost} | {live} | {p50} | {p99} | {bytes:.0} |\n");
        text.push_str(&row);
    }
    text
}

/// For programs: one figure a line.
pub(crate) fn json(rows: &[(&str, Figures)]) -> String {
    let mut text = String::new();
    for (name, Figures { lost, live_s, p50_s, p99_s, bytes }) in rows {
        let figures = [
            ("lost", Some(*lost as f64), "events"),
            ("live_after_return_s", *live_s, "s"),
            ("latency_p50_s", Some(*p50_s), "s"),
            ("latency_p99_s", Some(*p99_s), "s"),
            ("bytes_per_event", Some(*bytes), "B"),
        ];
        for (figure, value, unit) in figures {
            let line =
                serde_json::json!({ "name": figure, "way": name, "value": value, "unit": unit });
            writeln!(text, "{line}").unwrap_or_default();
        }
    }
    text
}
