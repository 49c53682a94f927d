//! `rafcon attach`: a second pair of eyes and hands on a run that is going on.

mod visit;

use crate::cli;
use crate::clock::Clock;
use crate::commands::run::{names_of_run, view};
use crate::console::{Console, Wish};
use crate::environment::Environment;
use crate::failure::complain;
use crate::runs;
use crate::view::View;
use crate::wires::{self, Cause, Wires};
use anyhow::Result;
use rafcon_protocol::{Hello, Join, ToViewer, encode};
use rafcon_supervisor::{machine_of, socket};
use std::io::{self, IsTerminal as _, Write as _};
use std::os::unix::net::UnixStream;
use std::process::ExitCode;
pub(super) use visit::envelope;
use visit::{Act, End, Visit};

/// Follows a run until it ends or the user leaves.
pub(super) fn attach(
    raw: &cli::Attach,
    environment: &Environment,
    clock: Clock,
) -> Result<ExitCode> {
    let folder = runs::find(&raw.runs, environment, &raw.run)?;
    let control = socket::connect(&folder)?;
    let has_keys = raw.output == cli::Output::Text
        && io::stdout().is_terminal()
        && io::stdin().is_terminal()
        && !environment.dumb_terminal;
    let console = has_keys.then(|| Console::new(true));
    let view = view(raw.output, environment, names_of_run(machine_of(&folder)), console);
    let join = Join { from: raw.from, every_event: view.every_event(), values: false };
    let mut wires = Wires::new(wires::signals()?, has_keys)?;
    wires.join(control.try_clone()?)?;
    let visit = Visit::new(join, &environment.user);
    let end = Guest { visit, view, control, clock }.until_the_end(&wires)?;
    if let Some(text) = end.text(&runs::id(&folder)) {
        complain(&text);
    }
    Ok(ExitCode::from(end.code()))
}

struct Guest {
    visit: Visit,
    view: Box<dyn View>,
    control: UnixStream,
    clock: Clock,
}

impl Guest {
    fn until_the_end(mut self, wires: &Wires) -> Result<End> {
        self.control.write_all(&encode(&Hello::ours())?)?;
        let mut acts = Vec::new();
        loop {
            let cause = wires.next(self.view.rhythm());
            let cause = self.by_itself(cause);
            self.visit.handle(cause, &mut acts);
            for act in acts.drain(..) {
                self.act(act)?;
            }
            self.view.refresh(self.clock.now())?;
            if let Some(end) = self.visit.end() {
                self.view.end(&end.for_view())?;
                return Ok(end.clone());
            }
        }
    }

    /// A key becomes what it stands for; the rest concerns this program alone.
    fn by_itself(&mut self, cause: Cause) -> Cause {
        match cause {
            Cause::Key(key) => self.view.key(key).map_or(Cause::Tick, Cause::Wish),
            Cause::HungUp => Cause::Wish(Wish::Leave),
            Cause::Suspend => {
                self.view.set_aside().unwrap_or_default();
                let stop = signal_hook::consts::SIGTSTP;
                signal_hook::low_level::emulate_default_handler(stop).unwrap_or_default();
                Cause::Tick
            }
            cause => cause,
        }
    }

    fn act(&mut self, act: Act) -> Result<()> {
        let now = self.clock.now();
        match act {
            Act::Send(message) => self.control.write_all(&encode(&message)?).unwrap_or_default(),
            Act::Show(ToViewer::Loaded { name, states, .. }) => self.view.loaded(&name, states)?,
            Act::Show(ToViewer::Event { t_ns, event, .. }) => {
                self.view.event(std::time::Duration::from_nanos(t_ns), event)?;
            }
            Act::Show(ToViewer::Snapshot(snapshot)) => self.view.snapshot(now, snapshot)?,
            Act::Show(ToViewer::Inspection { path, data, .. }) => {
                self.view.inspected(&path, data)?;
            }
            Act::Show(ToViewer::LoadFailed { .. } | ToViewer::Answer { .. }) => {}
            Act::Note(text) => self.view.note(&text)?,
        }
        Ok(())
    }
}
