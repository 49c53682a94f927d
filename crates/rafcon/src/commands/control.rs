//! `rafcon control`: control of a run at a server.

use super::remote;
use crate::cli;
use crate::environment::Environment;
use crate::view::{harmless, time};
use anyhow::{Context as _, Result};
use rafcon_protocol::api::{Control, ControlMove};
use rafcon_supervisor::clock::since_1970_ms;
use std::io::{self, Write as _};
use std::process::ExitCode;
use std::time::Duration;

/// Sends a request about control, and prints the current state of control.
pub(super) fn control(raw: &cli::Control, environment: &Environment) -> Result<ExitCode> {
    let wanted = wanted(raw)?;
    let server = remote::meet(&raw.server, &raw.access, environment)?;
    let run = remote::run(&server, &raw.run)?.id;
    let control = match &wanted {
        None => server.holder(&run)?,
        Some(wanted) => server.control(&run, wanted)?,
    };
    writeln!(io::stdout(), "{}", words(&control, since_1970_ms()))?;
    Ok(ExitCode::SUCCESS)
}

fn wanted(raw: &cli::Control) -> Result<Option<ControlMove>> {
    Ok(Some(match raw.wanted {
        cli::Wanted::Show => return Ok(None),
        cli::Wanted::Request => ControlMove::Request,
        cli::Wanted::Withdraw => ControlMove::Withdraw,
        cli::Wanted::Release => ControlMove::Release,
        cli::Wanted::TakeOver => ControlMove::TakeOver,
        cli::Wanted::Accept => ControlMove::Accept,
        cli::Wanted::Decline => ControlMove::Decline,
        cli::Wanted::Override => ControlMove::Override,
        cli::Wanted::HandOver => {
            ControlMove::HandOver { to: raw.user.clone().context("name the user")? }
        }
    }))
}

fn words(control: &Control, now_ms: u64) -> String {
    let Some(holder) = &control.holder else {
        return "no user is in control; the first user to give a command gets control".to_owned();
    };
    let ago = time(Duration::from_millis(now_ms.saturating_sub(control.heard_ms)));
    let mut text = format!("{} is in control, last active {ago} ago", harmless(holder));
    if let Some(user) = &control.offered_to {
        text.extend(["; offered to ", &harmless(user), ", who has not accepted yet"]);
    }
    if !control.requests.is_empty() {
        let names: Vec<String> = control.requests.iter().map(|name| harmless(name)).collect();
        text.extend(["; requested by ", &names.join(", ")]);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::words;
    use rafcon_protocol::api::Control;

    #[test]
    fn control_is_told_in_a_line() {
        assert_eq!(
            words(&Control::default(), 0),
            "no user is in control; the first user to give a command gets control"
        );
        let requests = vec!["bo".to_owned(), "cy".to_owned()];
        let holder = Some("ana".to_owned());
        let control = Control { holder, heard_ms: 1000, requests, ..Control::default() };
        assert_eq!(
            words(&control, 3500),
            "ana is in control, last active 2.5 s ago; requested by bo, cy"
        );
        let control = Control { requests: vec![], offered_to: Some("di".to_owned()), ..control };
        assert_eq!(
            words(&control, 3500),
            "ana is in control, last active 2.5 s ago; offered to di, who has not accepted yet"
        );
    }
}
