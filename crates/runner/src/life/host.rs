//! One run from the hello to its last event. This module knows the order of the steps; other modules implement them.

use crate::drive::document::Document;
use crate::drive::driver::Driver;
use crate::drive::due;
use crate::drive::ending::RunEnd;
use crate::drive::error::{CommandError, LoadFailure};
use crate::drive::prepare::{Prepared, prepare};
use crate::life::resume::{Resumed, ResumedPast};
use crate::life::{committer, end_values, journal};
use crate::places::active::Active;
use crate::record::recorder::Recorder;
use crate::record::tell;
use crate::viewers::commands::Answers;
use crate::viewers::connection::{self, Line, Socket, TalkError};
use crate::viewers::listener::{ListenerCloser, ViewerListener};
use crate::viewers::viewer_set::ViewerSet;
use crate::{Clock, Host, Scripts};
use rafcon_engine::{Finish, Input, Program, Start};
use rafcon_model::Machine;
use rafcon_protocol::{Event, Join, Launch, LogLevel, Outcome, ToRunner, ToViewer};
use rafcon_storage::journal::folder::{EndValues, VALUES_FOLDER};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::{Handle, Signals};
use std::io;
use std::ops::ControlFlow;
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::sync::Arc;
use std::thread::{self, Scope};

/// The exit status of a runner whose engine failed.
const BROKEN: i32 = 87;

/// A reason why no run took place.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The connection to the viewer failed.
    #[error(transparent)]
    Talk(#[from] TalkError),
    /// The first message was not a launch.
    #[error("the viewer's first message is not a launch")]
    NoLaunch,
    /// The machine cannot be run. The viewer has received the reason.
    #[error(transparent)]
    Load(#[from] LoadFailure),
    /// The system refused a thread or a signal handler.
    #[error("the system refused a thread or a signal handler")]
    System(#[from] io::Error),
}

/// Runs the launch of the viewer at the other end of `stream`, to its end. Called outside the interpreter.
pub fn serve<H: Host>(stream: UnixStream, host: H) -> Result<(), ServeError> {
    let clock = Clock::start();
    let mut line = connection::open(Socket::new(stream))?;
    let ToRunner::Launch(launch) = line.receiver.message()? else {
        return Err(ServeError::NoLaunch);
    };
    match begin(host, &launch, clock) {
        Ok(begun) => begun.run(line, &launch),
        Err(error) => {
            line.sender.send(&ToViewer::LoadFailed { reason: error.to_string() });
            Err(error)
        }
    }
}

/// Loads the machine, prepares everything and starts or resumes the run.
fn begin<H: Host>(
    mut host: H,
    launch: &Launch,
    clock: Clock,
) -> Result<Begun<H::Scripts>, ServeError> {
    host.launched(launch);
    let resumed = launch.resume.map(|resume| Resumed::open(launch, resume));
    let resumed = resumed.transpose().map_err(LoadFailure::from)?;
    let prepared = match &resumed {
        Some(resumed) => resumed.prepare(&mut host, launch),
        None => prepare(&mut host, launch, None).map_err(LoadFailure::from),
    };
    let Prepared { machine, files, problems, start, config, source } = prepared?;
    let program = Arc::new(Program::compile(&machine, host.literals()));
    if let Some(path) = &start.start_from {
        program.find(path).map_err(LoadFailure::from)?;
    }
    let loaded = loaded(launch, &machine, problems);
    let document = Document::new(machine.clone(), Arc::clone(&program), source);
    let is_kept = resumed.as_ref().is_some_and(|resumed| resumed.kept_machine().is_some());
    let (recorder, past) = record(launch, &machine, clock, resumed)?;
    let keeping = recorder.keeping();
    let values = launch.run_folder.as_ref().map(|folder| folder.join(VALUES_FOLDER));
    let opening =
        crate::Opening { machine, program, files: files.clone(), config, keeping, values };
    let active = match &launch.run_folder {
        Some(folder) => Active::open(folder)?,
        None => Active::default(),
    };
    let clock = clock.after(past.as_ref().map_or(0, |past| past.resume_point.t_ns));
    let from = past.as_ref().map_or(0, |past| past.resume_point.sequence) + 1;
    let driver = Driver::new(document, host.open(opening), clock, active, recorder);
    H::opened(&driver);
    driver.roots().keep_first(driver.record(), &driver.machine(), files, is_kept);
    let (door, closer) = open_door(launch)?.unzip();
    let answers = past.as_ref().map(ResumedPast::answers).unwrap_or_default();
    let begun =
        Begun { driver, loaded, from, answers, signals: take_over_signals()?, door, closer };
    let is_new = past.is_none();
    match set_out(&begun.driver, launch, start, past) {
        Ok(()) => Ok(begun),
        Err(why) => {
            // A run that never began leaves no journal.
            let journal = begun.driver.recorder().journal().filter(|_| is_new);
            Err(ServeError::Load(match journal.map(|journal| journal.discard()) {
                Some(Err(error)) => LoadFailure::JournalStays { why, journal: Box::new(error) },
                Some(Ok(())) | None => why.into(),
            }))
        }
    }
}

fn loaded(launch: &Launch, machine: &Machine, problems: Vec<String>) -> ToViewer {
    ToViewer::Loaded {
        name: machine.root.name.to_string(),
        states: machine.count() as u64,
        run: launch.run_folder.as_deref().map(run_id).unwrap_or_default(),
        problems,
    }
}

/// Opens the record of a run that begins or continues.
fn record(
    launch: &Launch,
    machine: &Machine,
    clock: Clock,
    resumed: Option<Resumed>,
) -> Result<(Recorder, Option<ResumedPast>), ServeError> {
    let failed = |error| ServeError::Load(LoadFailure::Journal(Box::new(error)));
    if let Some(resumed) = resumed {
        let (recorder, past) = resumed.recorder();
        recorder.folder().map_or(Ok(()), EndValues::remove).map_err(failed)?;
        return Ok((recorder, Some(past)));
    }
    let recorder = journal::begin(launch, machine, clock);
    Ok((recorder.map_err(failed)?, None))
}

/// The id of the run: the name of its folder.
fn run_id(folder: &Path) -> String {
    folder.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// A run that has begun, with everything that it needs.
struct Begun<S: Scripts> {
    driver: Arc<Driver<S>>,
    loaded: ToViewer,
    /// Number of the first event for the viewer that launched the run.
    from: u64,
    /// Commands that earlier runners have answered.
    answers: Answers,
    signals: (Signals, Handle),
    door: Option<ViewerListener>,
    closer: Option<ListenerCloser>,
}

impl<S: Scripts> Begun<S> {
    fn run(self, line: Line, launch: &Launch) -> Result<(), ServeError> {
        let Self { driver, loaded, from, answers, signals: (signals, handle), door, closer } = self;
        let viewers = ViewerSet::new(Arc::clone(&driver), loaded, answers);
        let (driver, viewers) = (&driver, &viewers);
        thread::scope(|scope| {
            let watch = Watch { line, join: first(launch, from), signals, door };
            let started = watch.begin(scope, driver, viewers);
            let end = match &started {
                Ok(()) => conclude(driver),
                Err(error) => abandon(driver, error),
            };
            drop(closer);
            viewers.part(|| {
                if end.is_continue() {
                    handle.close();
                    driver.scripts().released();
                }
            });
            if let ControlFlow::Break(status) = end {
                exit(status);
            }
            started.map_err(ServeError::System)
        })
    }
}

/// The sources of a run's inputs: its viewers, signals and the listener.
struct Watch {
    line: Line,
    join: Join,
    signals: Signals,
    door: Option<ViewerListener>,
}

impl Watch {
    /// Starts the threads of a run.
    fn begin<'scope, S: Scripts>(
        self,
        scope: &'scope Scope<'scope, '_>,
        driver: &'scope Arc<Driver<S>>,
        viewers: &'scope ViewerSet<S>,
    ) -> io::Result<()> {
        let Self { line, join, signals, door } = self;
        let named = |name: &str| thread::Builder::new().name(name.to_owned());
        committer::start(scope, driver)?;
        viewers.welcome(scope, line, join)?;
        named("signals").spawn_scoped(scope, || stop_at_signals(driver, signals))?;
        named("timers").spawn_scoped(scope, || due::serve(driver))?;
        if let Some(door) = door {
            named("door").spawn_scoped(scope, || door.serve(scope, viewers))?;
        }
        Ok(())
    }
}

/// The join of the viewer that launched the run.
fn first(launch: &Launch, from: u64) -> Join {
    Join { from, every_event: launch.every_event }
}

fn open_door(launch: &Launch) -> io::Result<Option<(ViewerListener, ListenerCloser)>> {
    let folder = launch.run_folder.as_deref().filter(|_| launch.listen);
    folder.map(ViewerListener::open).transpose()
}

/// Sets the breakpoints, and starts or resumes the run.
fn set_out<S: Scripts>(
    driver: &Arc<Driver<S>>,
    launch: &Launch,
    start: Start<S::Value>,
    past: Option<ResumedPast>,
) -> Result<(), CommandError> {
    if let Some(past) = past {
        past.go_on(driver, start, launch.hold)?;
        driver.scripts().note_globals();
        return Ok(());
    }
    launch.breakpoints.iter().try_for_each(|breakpoint| driver.set_breakpoint(breakpoint))?;
    driver.set_globals(&launch.globals)?;
    driver.scripts().note_globals();
    Ok(driver.command(Input::Start(start))?)
}

/// Waits for the end of the run and records it. Breaks off if a script does not end. Then the interpreter is not
/// entered any more, because that script may never leave it.
fn conclude<S: Scripts>(driver: &Driver<S>) -> ControlFlow<i32> {
    let end = driver.wait();
    let flow = match end {
        Some(RunEnd::Finished(finish)) => {
            driver.close();
            driver.scripts().ended(&finish);
            driver.scripts().finished();
            driver.roots().close(driver.recorder());
            let event = finished(driver.scripts(), finish);
            driver.record().end(bounded(driver, event));
            ControlFlow::Continue(())
        }
        Some(RunEnd::Broken) => ControlFlow::Break(BROKEN),
        Some(RunEnd::CutOff) | None => ControlFlow::Break(due::CUT_OFF),
    };
    driver.recorder().close();
    flow
}

/// Ends a run that cannot get all its threads, and asks its scripts to end.
pub(crate) fn abandon<S: Scripts>(driver: &Arc<Driver<S>>, error: &io::Error) -> ControlFlow<i32> {
    let message = format!("cannot start a thread for this run, which ends: {error}");
    driver.record().note_until_over(tell::log(String::new(), LogLevel::Error, message));
    driver.roots().dismiss();
    driver.timers().close();
    driver.recorder().abandon();
    // Refused if the run has ended meanwhile.
    drop(driver.command(Input::Stop));
    ControlFlow::Continue(())
}

/// Ends the process with all its threads.
fn exit(status: i32) -> ! {
    signal_hook::low_level::exit(status)
}

/// The last event with limited values, if the run has a folder for all of them.
fn bounded<S: Scripts>(driver: &Driver<S>, event: Event) -> Event {
    let Some(folder) = driver.recorder().folder() else { return event };
    let (event, notes) = end_values::bounded(event, folder);
    for (level, message) in notes {
        driver.record().note_until_over(tell::log(String::new(), level, message));
    }
    event
}

fn finished<S: Scripts>(scripts: &S, finish: Finish<S::Value>) -> Event {
    let encode = |values: Vec<(smol_str::SmolStr, S::Value)>| {
        values.iter().map(|(name, value)| (name.to_string(), scripts.encode(value))).collect()
    };
    Event::Finished {
        outcome: Outcome { id: finish.outcome.0, name: finish.outcome_name.to_string() },
        outputs: encode(finish.outputs),
        globals: scripts.encode_globals(),
        scoped_variables: encode(finish.scoped_variables),
        states_run: finish.states_run,
    }
}

/// Handles signals of the system from now on. The second value ends [`stop_at_signals`].
fn take_over_signals() -> io::Result<(Signals, Handle)> {
    let signals = Signals::new([SIGINT, SIGTERM, SIGHUP])?;
    let handle = signals.handle();
    Ok((signals, handle))
}

/// Stops the run at each signal, until the handle is closed. The hang-up of a terminal is ignored.
fn stop_at_signals<S: Scripts>(driver: &Arc<Driver<S>>, mut signals: Signals) {
    for signal in signals.forever() {
        if signal != SIGHUP {
            driver.reach_for_stop(|_why| ());
            // Refused if the run is over or has not begun, so nothing needs to stop.
            drop(driver.command(Input::Stop));
        }
    }
}
