//! One run from hello to the last word. Knows the order of things; the parts know how.

use crate::active::Active;
use crate::connection::{self, Receiver, Sender, Socket, TalkError};
use crate::document::Document;
use crate::driver::Driver;
use crate::prepare::{Prepared, prepare};
use crate::viewer::Viewer;
use crate::{Clock, Host, Scripts, commands, stop, tell};
use parking_lot::{Condvar, Mutex};
use rafcon_engine::{Finish, Input, Program, Refusal};
use rafcon_protocol::{Event, Keeping, Outcome, ToRunner, ToViewer};
use signal_hook::iterator::Signals;
use std::io;
use std::os::unix::net::UnixStream;
use std::sync::Arc;
use std::thread;
use std::time::Duration;

/// How long a viewer that does not read may hold up the end of the process, after the run is over.
const LAST_WORDS: Duration = Duration::from_secs(10);

/// Why there was no run.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The talk did not begin.
    #[error(transparent)]
    Talk(#[from] TalkError),
    /// The first message was something else.
    #[error("the viewer's first message is not a launch")]
    NoLaunch,
    /// The machine cannot be run; the viewer was told.
    #[error("{0}")]
    Load(String),
    /// The system refused what every run needs.
    #[error("the system refused a thread or a signal handler")]
    System(#[from] io::Error),
}

/// Runs what the viewer at the other end of `stream` asks for, to its end. Called outside the interpreter.
pub fn serve<H: Host>(stream: UnixStream, host: H) -> Result<(), ServeError> {
    let clock = Clock::start();
    let (sender, mut receiver, socket) = connection::open(stream)?;
    let ToRunner::Launch(launch) = receiver.message()? else { return Err(ServeError::NoLaunch) };
    let every_event = launch.every_event;
    match begin(host, &launch, clock, &sender) {
        Ok((driver, signals)) => {
            Talk { driver, sender, socket, every_event }.run(receiver, signals)
        }
        Err(error) => {
            sender.send(&ToViewer::LoadFailed { reason: error.to_string() });
            Err(error)
        }
    }
}

type Begun<H> = (Arc<Driver<<H as Host>::Scripts>>, (Signals, signal_hook::iterator::Handle));

/// Loads the machine and begins the run.
fn begin<H: Host>(
    mut host: H,
    launch: &rafcon_protocol::Launch,
    clock: Clock,
    sender: &Sender,
) -> Result<Begun<H>, ServeError> {
    let Prepared { machine, files, problems, start, config } =
        prepare(&mut host, launch).map_err(ServeError::Load)?;
    let program = Arc::new(Program::compile(&machine, host.literals()));
    if let Some(path) = &start.start_from {
        program.find(path).map_err(|unknown| ServeError::Load(unknown.to_string()))?;
    }
    let loaded = ToViewer::Loaded {
        name: machine.root.name.to_string(),
        states: machine.count() as u64,
        run: String::new(),
        problems,
    };
    let document = Document::new(machine.clone(), Arc::clone(&program));
    let opening =
        crate::Opening { machine, program, files, config, keeping: Keeping::Off, values: None };
    let active = match &launch.run_folder {
        Some(folder) => Active::open(folder)?,
        None => Active::default(),
    };
    let driver = Driver::new(document, host.open(opening), clock, active);
    H::opened(&driver);
    let signals = stop::take_over()?;
    sender.send(&loaded);
    driver.command(Input::Start(start)).map_err(|refusal| refused(&refusal))?;
    Ok((driver, signals))
}

fn refused(refusal: &Refusal) -> ServeError {
    ServeError::Load(refusal.to_string())
}

/// A run that has begun, and its viewer.
struct Talk<S: Scripts> {
    driver: Arc<Driver<S>>,
    sender: Sender,
    socket: Socket,
    every_event: bool,
}

impl<S: Scripts> Talk<S> {
    fn run(
        self,
        receiver: Receiver,
        (signals, handle): (Signals, signal_hook::iterator::Handle),
    ) -> Result<(), ServeError> {
        let (told, answering) = (Told::default(), Mutex::new(()));
        thread::scope(|scope| {
            let named = |name: &str| thread::Builder::new().name(name.to_owned());
            named("commands").spawn_scoped(scope, || {
                commands::serve(&self.driver, receiver, &self.sender, &answering);
            })?;
            named("signals").spawn_scoped(scope, || stop::serve(&self.driver, signals))?;
            named("viewer").spawn_scoped(scope, || {
                Viewer::new(&self.driver, &self.sender, self.every_event).follow();
                told.set();
            })?;
            self.conclude(&told);
            // A command that ended the run is answered like any other.
            drop(answering.try_lock_for(LAST_WORDS));
            handle.close();
            self.driver.scripts().released();
            self.socket.shut();
            Ok(())
        })
    }

    /// Waits for the end of the run, and until it is told.
    fn conclude(&self, told: &Told) {
        if let Some(finish) = self.driver.wait() {
            self.driver.close();
            self.driver.scripts().finished();
            let event = tell::told(finished(self.driver.scripts(), finish));
            self.driver.recorder().push(self.driver.clock().now_ns(), [event]);
        }
        self.driver.recorder().close();
        told.wait(LAST_WORDS);
    }
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

/// Whether the viewer has been told everything.
#[derive(Debug, Default)]
struct Told {
    done: Mutex<bool>,
    changed: Condvar,
}

impl Told {
    fn set(&self) {
        *self.done.lock() = true;
        self.changed.notify_all();
    }

    fn wait(&self, at_most: Duration) {
        let mut done = self.done.lock();
        if !*done {
            self.changed.wait_while_for(&mut done, |done| !*done, at_most);
        }
    }
}
