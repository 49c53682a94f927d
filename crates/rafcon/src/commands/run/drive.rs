//! The runners of a run, one after the other: each is started, followed to its end, and followed by the next if its death allows
//! that. Decides nothing itself.

use super::place::Place;
use crate::clock::Clock;
use crate::event_queue::{self, EventQueue};
use crate::failure::complain;
use crate::follow::{End, Follower, Role, RunLoop};
use crate::view::View;
use anyhow::Result;
use rafcon_protocol::Launch;
use rafcon_supervisor::clock::salt;
use rafcon_supervisor::{BeginError, Group, KeptRun, Next, RestartPolicy, Start, begin, remains};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::Duration;

/// What a run needs from the outside.
pub(super) struct RunEnvironment<'a> {
    /// How runners are started.
    pub(super) start: &'a Start<'a>,
    /// What shows it.
    pub(super) view: Box<dyn View>,
    /// Whether there is a keyboard.
    pub(super) has_keys: bool,
    pub(super) clock: Clock,
    /// Who gives commands.
    pub(super) author: &'a str,
    /// When the machine is stopped.
    pub(super) timeout: Option<Duration>,
}

/// Runs the machine to its end, by as many runners as that takes and its policy allows.
pub(super) fn follow(launch: Launch, place: &Place, outside: RunEnvironment<'_>) -> Result<End> {
    let RunEnvironment { start, mut view, has_keys, clock, author, timeout } = outside;
    let mut queue = EventQueue::new(event_queue::signals()?, has_keys)?;
    let deadline = timeout.map(|timeout| clock.now().saturating_add(timeout));
    let (mut lives, mut launch) = (RestartPolicy::default(), launch);
    loop {
        let process = start.spawn()?;
        let (control, group) = (process.control.try_clone()?, process.group());
        queue.connect(process)?;
        say(&control, group, launch.clone());
        let prefix = format!("run-{}-{}", std::process::id(), salt(0));
        let follower = Follower::new(Role::Owner, author, prefix, deadline);
        let line = Box::new(control);
        let mut run = RunLoop { follower, view, line, group: Some(group), clock };
        let mut end = run.until_the_end(&queue).inspect_err(|_| group.kill())?;
        add_running(&mut end, place.folder());
        end_as_kept(&mut run, &mut end, place)?;
        let again = match &end {
            End::Died(death) if place.is_kept() => {
                let kept = KeptRun::of(place.folder(), launch.on_crash);
                let what = if kept.has_begun { "taken up" } else { "begun" };
                let note = format!("the runner died ({}); the run is {what} again", death.reason);
                match lives.next(clock.now(), death, kept, launch) {
                    Next::Again(again) => Some((again, note)),
                    Next::Ask(_) => None,
                }
            }
            _ => None,
        };
        let Some((again, note)) = again else {
            run.show(|view| view.end(&end))?;
            return Ok(end);
        };
        run.show(|view| view.note(&note))?;
        (launch, view) = (*again, run.view);
    }
}

/// Says what to run. A runner that is gone already is noticed by its end.
fn say(control: &UnixStream, group: Group, launch: Launch) {
    match begin(control, launch) {
        Ok(()) | Err(BeginError::Gone(_)) => {}
        Err(error @ (BeginError::Launch(_) | BeginError::Silent(_))) => {
            complain(&format!("error: {error}"));
            group.kill();
        }
    }
}

/// A runner that died after the run had ended took nothing along but its last word.
fn end_as_kept(run: &mut RunLoop, end: &mut End, place: &Place) -> Result<()> {
    if !matches!(end, End::Died(_)) || !place.is_kept() {
        return Ok(());
    }
    let Some((time, event)) = remains::kept_end(place.folder()) else { return Ok(()) };
    if let Some(kept) = End::kept(&event) {
        run.show(|view| view.event(time, event))?;
        *end = kept;
    }
    Ok(())
}

/// The runner's own marks of what runs are better than its last messages: they were made before each script began.
fn add_running(end: &mut End, folder: &Path) {
    let Some(known) = end.active_mut() else { return };
    let running = remains::running(folder);
    if !running.is_empty() {
        *known = running;
    }
}
