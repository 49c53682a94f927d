//! A run on this computer: its folder, and its runners in sequence. Each runner is started and followed to its end; another
//! one follows if the policy allows it. Decides nothing itself.

use super::limits::ends_itself;
use super::own_line::OwnLine;
use super::watchdog::Watchdog;
use super::{is_terminal, keyboard, view};
use crate::cli;
use crate::clock::Clock;
use crate::environment::Environment;
use crate::event_queue::EventQueue;
use crate::follow::{End, RunFollower, RunLoop, RunRole};
use crate::view::Names;
use anyhow::{Context as _, Result};
use rafcon_protocol::{Event, Launch};
use rafcon_storage::journal::folder::{ABOUT_FILE, EndValues};
use rafcon_supervisor::clock::salt;
use rafcon_supervisor::{KeptRun, Next, RestartPolicy, RunnerDeath, Start, crash_artifacts};
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::time::Duration;

/// Folder of a run.
#[derive(Debug)]
pub(super) enum Place {
    /// In the folder of runs.
    Kept(PathBuf),
    /// In a temporary folder.
    Passing(tempfile::TempDir),
}

impl Place {
    /// A temporary folder, removed with the run.
    pub(super) fn passing() -> Result<Self> {
        let folder = tempfile::Builder::new().prefix("rafcon-run-").tempdir();
        Ok(Self::Passing(folder.context("cannot create a folder for the run")?))
    }

    pub(super) fn folder(&self) -> &Path {
        match self {
            Self::Kept(folder) => folder,
            Self::Passing(folder) => folder.path(),
        }
    }

    /// True if the run is recorded and can be resumed.
    pub(super) fn is_kept(&self) -> bool {
        matches!(self, Self::Kept(_))
    }

    /// Name of the run, if it can be resumed.
    pub(super) fn kept_run(&self) -> Option<&str> {
        let Self::Kept(folder) = self else { return None };
        folder.file_name()?.to_str().filter(|_| self.keeps_itself())
    }

    /// True if the folder has a description of its run, which a resume needs.
    fn keeps_itself(&self) -> bool {
        self.folder().join(ABOUT_FILE).exists()
    }
}

impl Drop for Place {
    /// Removes the folder of a run that never began.
    fn drop(&mut self) {
        if self.is_kept() && !self.keeps_itself() {
            // A leftover folder is harmless.
            std::fs::remove_dir_all(self.folder()).unwrap_or_default();
        }
    }
}

/// Settings for starting and showing a run.
pub(super) struct RunSetup<'a> {
    pub(super) python: &'a cli::Python,
    pub(super) output: cli::Output,
    /// Time limit of the machine, from the start of this program.
    pub(super) timeout: Option<Duration>,
    pub(super) environment: &'a Environment,
    pub(super) clock: Clock,
}

impl RunSetup<'_> {
    /// Runs the machine to its end, with as many runners as needed and allowed by its policy.
    pub(super) fn follow(
        self,
        mut launch: Launch,
        place: &Place,
        names: &Rc<dyn Fn() -> Names>,
    ) -> Result<End> {
        let Self { python, output, timeout, environment, clock } = self;
        let start = Start::find(python.python.as_deref(), &environment.locations)?;
        let keyboard = keyboard(output, environment, false);
        let has_keys = keyboard.is_some();
        let mut view = view(output, environment, names(), keyboard);
        launch.every_event = view.every_event();
        let mut queue = EventQueue::new(has_keys)?;
        let is_attended = output == cli::Output::Text && is_terminal(environment);
        let mut lives = RestartPolicy::default();
        loop {
            let process = start.spawn(has_keys)?;
            let (control, group) = (process.control.try_clone()?, process.group());
            queue.connect(process)?;
            let line = Box::new(OwnLine::open(control, group, launch.clone())?);
            let watchdog = Watchdog::start(timeout, clock, group)?;
            let prefix = format!("run-{}-{}", std::process::id(), salt(0));
            let mut follower = RunFollower::new(RunRole::Owner, &environment.user, prefix, timeout);
            if !is_attended {
                let names = Rc::clone(names);
                follower = follower.unattended(move || names().machine().is_some_and(ends_itself));
            }
            let mut run = RunLoop { follower, view, line, group: Some(group), clock };
            let mut end = run.until_the_end(&queue).inspect_err(|_| group.kill())?;
            add_running(&mut end, place.folder());
            end_as_kept(&mut run, &mut end, place)?;
            drop(watchdog);
            show_end_values(&mut run, &end, place)?;
            let Some((next, note)) = again(&mut lives, clock.now(), &end, place, launch) else {
                run.show(|view| view.end(&end))?;
                return Ok(end);
            };
            run.show(|view| view.note(&note))?;
            (launch, view) = (next, run.view);
        }
    }
}

/// Launch of the next runner and a note for the user, if the run is resumed after this end.
fn again(
    lives: &mut RestartPolicy,
    now: Duration,
    end: &End,
    place: &Place,
    launch: Launch,
) -> Option<(Launch, String)> {
    let End::Died(death) = end else { return None };
    if !place.is_kept() {
        return None;
    }
    let kept = KeptRun::of(place.folder(), launch.on_crash);
    let what = if kept.has_begun { "resumed" } else { "started again" };
    match lives.next(now, death, kept, launch) {
        Next::Again(launch) => {
            let note = format!("the runner died ({}); the run is {what}", death.reason);
            Some((*launch, note))
        }
        Next::Ask(_) => None,
    }
}

/// Reads the end from the journal, if a runner died after the run had ended.
fn end_as_kept(run: &mut RunLoop, end: &mut End, place: &Place) -> Result<()> {
    if let End::Died(_) = end
        && place.is_kept()
        && let Some((time, event)) = crash_artifacts::kept_end(place.folder())
        && let Event::Finished { outcome, .. } = &event
    {
        *end = End::Finished { outcome: outcome.clone(), timed_out: false };
        run.show(|view| view.event(time, event))?;
    }
    Ok(())
}

/// Shows all values at the end of a run, if its last event has only their views.
fn show_end_values(run: &mut RunLoop, end: &End, place: &Place) -> Result<()> {
    if !matches!(end, End::Finished { .. }) {
        return Ok(());
    }
    match EndValues::read(place.folder()) {
        Ok(values) => values.map_or(Ok(()), |values| run.show(|view| view.end_values(values))),
        Err(error) => run.show(|view| view.note(&format!("the values are shortened: {error}"))),
    }
}

/// Adds the active scripts from the runner's own marks. They are more reliable than its last messages, because each is
/// written before its script begins.
fn add_running(end: &mut End, folder: &Path) {
    if let End::Killed { active, .. } | End::Died(RunnerDeath { active, .. }) = end {
        let running = crash_artifacts::running(folder);
        if !running.is_empty() {
            *active = running;
        }
    }
}
