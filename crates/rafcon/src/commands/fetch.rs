//! `rafcon fetch`: transfers a large value from a robot to its station.

use super::remote;
use crate::cli;
use crate::client::{Server, escaped};
use crate::environment::Environment;
use crate::failure::complain;
use crate::view::{harmless, size, time};
use anyhow::{Result, bail};
use rafcon_protocol::api::{EventDetail, FetchValue, KeptAs, KeptValue, NamedValue};
use std::io::{self, Write as _};
use std::process::ExitCode;
use std::thread;
use std::time::Duration;

/// Interval of polling the progress of a value.
const ASK_EVERY: Duration = Duration::from_millis(500);

/// Lists the large values of an event, or fetches one.
pub(super) fn fetch(raw: &cli::Fetch, environment: &Environment) -> Result<ExitCode> {
    let server = remote::meet(&raw.server, &raw.access, environment)?;
    let run = escaped(&remote::run(&server, &raw.run)?.id);
    let event: EventDetail = server.get(&format!("/runs/{run}/events/{}", raw.event))?;
    let Some(name) = &raw.name else {
        let values = event.values.iter().filter(|value| !matches!(value.value.kept, KeptAs::View));
        let mut lines: Vec<_> = values.map(in_words).collect();
        if lines.is_empty() {
            lines.push(format!("event {} has no large values", raw.event));
        }
        writeln!(io::stdout(), "{}", lines.join("\n"))?;
        return Ok(ExitCode::SUCCESS);
    };
    let Some(value) = event.values.into_iter().find(|value| value.name == *name) else {
        bail!("event {} has no large value `{name}`: without a name they are listed", raw.event)
    };
    let path = format!("/runs/{run}/values/{}", value.value.number);
    let fetching = format!("{path}/fetch");
    let now: KeptValue = if raw.cancel {
        server.delete(&fetching)?
    } else {
        server.send(&fetching, &FetchValue { budget: raw.budget })?
    };
    let named = NamedValue { value: now, ..value };
    if raw.cancel || raw.no_wait {
        writeln!(io::stdout(), "{}", in_words(&named))?;
        return Ok(ExitCode::SUCCESS);
    }
    complain(&format!("{}; Ctrl-C ends this program, not the fetch", in_words(&named)));
    wait(&server, &path, named)
}

/// Reports the progress of the transfer until it is complete.
fn wait(server: &Server, path: &str, mut named: NamedValue) -> Result<ExitCode> {
    let mut said = in_words(&named);
    loop {
        match &named.value.kept {
            KeptAs::OnRobot { fetch: Some(fetch), .. } if fetch.failed.is_some() => {
                bail!("{}", in_words(&named))
            }
            KeptAs::OnRobot { .. } => {}
            KeptAs::View | KeptAs::Pickle { .. } | KeptAs::Nothing { .. } => {
                writeln!(io::stdout(), "{}", in_words(&named))?;
                return Ok(ExitCode::SUCCESS);
            }
        }
        thread::park_timeout(ASK_EVERY);
        named.value = server.get(path)?;
        let words = in_words(&named);
        if words != said && matches!(named.value.kept, KeptAs::OnRobot { .. }) {
            complain(&words);
            said = words;
        }
    }
}

fn in_words(NamedValue { name, value }: &NamedValue) -> String {
    let KeptValue { type_name, kept, .. } = value;
    let what = format!("{}: {}", harmless(name), harmless(type_name));
    match kept {
        KeptAs::View => format!("{what}, shown whole"),
        KeptAs::Pickle { bytes } => format!("{what}, {} here", size(*bytes)),
        KeptAs::Nothing { reason } => format!("{what}, not kept: {}", harmless(reason)),
        KeptAs::OnRobot { bytes, link_bytes, takes_ms, fetch } => {
            let cost = match (link_bytes, takes_ms) {
                (None, _) => "this server does not receive that robot".to_owned(),
                (Some(cost), None) => {
                    format!("costs {} of the link; no signal from the robot", size(*cost))
                }
                (Some(cost), Some(ms)) => {
                    let takes = time(Duration::from_millis(*ms));
                    format!("costs {} of the link, about {takes} at its rate now", size(*cost))
                }
            };
            let so_far = fetch.as_ref().map_or(String::new(), |fetch| match &fetch.failed {
                Some(why) => format!("; {} are here, and no more come: {why}", size(fetch.here)),
                None => format!("; {} are here, the rest is on its way", size(fetch.here)),
            });
            format!("{what}, {} on the robot; {cost}{so_far}", size(*bytes))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::in_words;
    use expect_test::expect;
    use rafcon_protocol::api::{KeptAs, KeptValue, NamedValue, ValueFetch};

    #[test]
    fn a_value_says_what_it_costs_and_how_far_it_is() {
        let on_robot = |link_bytes, takes_ms, fetch| KeptAs::OnRobot {
            bytes: 2_000_000,
            link_bytes,
            takes_ms,
            fetch,
        };
        let coming = |failed: Option<&str>| {
            let failed = failed.map(str::to_owned);
            Some(ValueFetch { here: 500_000, budget: 2_000_000, failed })
        };
        let kept = [
            on_robot(None, None, None),
            on_robot(Some(2_200_000), None, None),
            on_robot(Some(2_200_000), Some(70_000), None),
            on_robot(Some(2_200_000), Some(70_000), coming(None)),
            on_robot(Some(2_200_000), Some(70_000), coming(Some("the robot is gone"))),
            KeptAs::Pickle { bytes: 2_000_000 },
            KeptAs::Nothing { reason: "its class is defined in a script".to_owned() },
        ];
        let words = kept.map(|kept| {
            let (type_name, view) = ("ndarray".to_owned(), serde_json::Value::Null);
            let value = KeptValue { number: 7, type_name, view, kept };
            in_words(&NamedValue { name: "cloud".to_owned(), value })
        });
        expect![[r"
            cloud: ndarray, 2.0 MB on the robot; this server does not receive that robot
            cloud: ndarray, 2.0 MB on the robot; costs 2.2 MB of the link; no signal from the robot
            cloud: ndarray, 2.0 MB on the robot; costs 2.2 MB of the link, about 1:10 at its rate now
            cloud: ndarray, 2.0 MB on the robot; costs 2.2 MB of the link, about 1:10 at its rate now; 500 KB are here, the rest is on its way
            cloud: ndarray, 2.0 MB on the robot; costs 2.2 MB of the link, about 1:10 at its rate now; 500 KB are here, and no more come: the robot is gone
            cloud: ndarray, 2.0 MB here
            cloud: ndarray, not kept: its class is defined in a script"]].assert_eq(&words.join("\n"));
    }
}
