//! The words of the command line, as clap reads them: the raw half. What they mean is checked by each command.

mod kept;
mod remote;
mod serve;

pub(crate) use kept::{
    Compare, Export, ExportFormat, History, KeptRun, ListRuns, Log, LogLevel, Replay,
};
pub(crate) use remote::{Access, Control, KeptRemote, Login, Remote, Wanted};
pub(crate) use serve::{Role, Serve, State, User, UserAction};

use crate::templates;
use clap::builder::PossibleValuesParser;
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

/// Runs, checks and shows hierarchical state machines whose states are written in Python.
#[derive(Debug, Parser)]
#[command(name = "rafcon", version, propagate_version = true, max_term_width = 100)]
#[command(after_help = "Start with `rafcon new hello`, then `rafcon run hello`.")]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Run(Run),
    Attach(Attach),
    Tell(Tell),
    Resume(Resume),
    Runs(ListRuns),
    History(History),
    Log(Log),
    Replay(Replay),
    Compare(Compare),
    Export(Export),
    Serve(Serve),
    User(User),
    Login(Login),
    Control(Control),
    Check(Check),
    Show(Show),
    Fmt(Fmt),
    New(New),
    Completions(Completions),
    Man(Man),
}

/// Run a machine until it ends.
///
/// On a terminal the active states are shown live; otherwise, or with `--output json`, every event is one line.
/// Ctrl-C asks the machine to stop in an orderly way, a second Ctrl-C kills it; Ctrl-Z puts the view aside and a
/// terminal that hangs up ends it, and both leave the run alive. Scripts read what is piped in; a terminal's keyboard
/// is not theirs.
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct Run {
    /// Folder of the machine (or a file in it); at a server the project and the folder in it, such as `robots/pick`
    pub(crate) path: PathBuf,
    /// Begin at this state: ids from the root down, joined by `/`
    #[arg(long, value_name = "STATE_PATH")]
    pub(crate) start_from: Option<String>,
    /// Value for an input port of the root, as JSON (repeat for more)
    #[arg(long = "input", value_name = "NAME=JSON")]
    pub(crate) inputs: Vec<String>,
    /// Global variable that is there before the first state runs, as JSON (repeat for more)
    #[arg(long = "global", value_name = "NAME=JSON")]
    pub(crate) globals: Vec<String>,
    #[command(flatten)]
    pub(crate) libraries: Libraries,
    #[command(flatten)]
    pub(crate) python: Python,
    /// What is written to the standard output
    #[arg(long, value_enum, default_value_t = Output::Text)]
    pub(crate) output: Output,
    /// Stop the machine after this time, and kill it if it does not end then
    #[arg(long, value_name = "SECONDS")]
    pub(crate) timeout: Option<f64>,
    #[command(flatten)]
    pub(crate) runs: Runs,
    #[command(flatten)]
    pub(crate) keeping: Keeping,
    /// Hold before the first state, to go on step by step or after breakpoints were set
    #[arg(long)]
    pub(crate) hold: bool,
    /// Hold at this state: path or name, then `after` if it is to be left first, then `if` and a Python condition over
    /// `inputs`, `outputs`, `scoped`, `outcome`, `gvm` (repeat for more)
    #[arg(long = "break", value_name = "STATE [after] [if CONDITION]")]
    pub(crate) breakpoints: Vec<String>,
    #[command(flatten)]
    pub(crate) remote: Remote,
}

/// What is kept of a run, and what becomes of it when its runner dies.
#[derive(Debug, Args)]
pub(crate) struct Keeping {
    /// How much of the run is kept
    #[arg(long, value_enum, default_value_t = Level::Full)]
    pub(crate) keep: Level,
    /// Let no script begin before everything up to it is safe from a power cut
    #[arg(long)]
    pub(crate) strict: bool,
    /// Size of the run's journal beyond which old detail is given up
    #[arg(long, value_name = "MEGABYTES")]
    pub(crate) keep_max: Option<u64>,
    /// What becomes of the scripts that were running if the runner dies; else what the root state's semantic data
    /// `on_crash` says, else `ask`
    #[arg(long, value_enum)]
    pub(crate) on_crash: Option<OnCrash>,
}

/// How much of a run is kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Level {
    /// Everything: it can be replayed and taken up again
    Full,
    /// States, outcomes, commands and the log, without values
    Status,
    /// Nothing
    Off,
}

/// What becomes of scripts that a crash has interrupted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum OnCrash {
    /// Nothing moves until somebody decides
    Ask,
    /// They are aborted, so that the machine's recovery transitions take over
    Abort,
    /// They run again, with the inputs that they had
    Restart,
}

/// Take up a run whose runner has died.
///
/// It goes on in its own folder, with the machine, the data and the history that it had.
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct Resume {
    /// The run: its id, the beginning of it, its folder, or `last`
    pub(crate) run: String,
    /// What becomes of the scripts that were running
    #[arg(long, value_enum, default_value_t = OnCrash::Ask)]
    pub(crate) policy: OnCrash,
    /// Go on from this `entered` event of its history instead, and hold there
    #[arg(long, value_name = "SEQUENCE")]
    pub(crate) from: Option<u64>,
    #[command(flatten)]
    pub(crate) runs: Runs,
    #[command(flatten)]
    pub(crate) python: Python,
    /// What is written to the standard output
    #[arg(long, value_enum, default_value_t = Output::Text)]
    pub(crate) output: Output,
    /// Stop the machine after this time, and kill it if it does not end then
    #[arg(long, value_name = "SECONDS")]
    pub(crate) timeout: Option<f64>,
    #[command(flatten)]
    pub(crate) remote: Remote,
}

/// Join a run that is going on: watch it, step it, answer its questions.
///
/// Leaving (`q` or Ctrl-C) leaves it running. `?` lists the keys.
#[derive(Debug, Args)]
pub(crate) struct Attach {
    /// The run: its id, the beginning of it, its folder, or `last`
    #[arg(default_value = "last")]
    pub(crate) run: String,
    #[command(flatten)]
    pub(crate) runs: Runs,
    /// What is written to the standard output
    #[arg(long, value_enum, default_value_t = Output::Text)]
    pub(crate) output: Output,
    /// Begin with this event of its history instead of now
    #[arg(long, value_name = "SEQUENCE", default_value_t = 0)]
    pub(crate) from: u64,
    #[command(flatten)]
    pub(crate) remote: Remote,
}

/// Say one command to a run that is going on, and print the answer.
///
/// The command is its name, then its fields as NAME=JSON (a text needs no quotes), such as
/// `rafcon tell last step_into` or `rafcon tell last force_outcome path=ROOT/SCAN outcome=0`.
/// docs/protocol.md lists them. Exits with 1 if it is refused.
#[derive(Debug, Args)]
pub(crate) struct Tell {
    /// The run: its id, the beginning of it, its folder, or `last`
    pub(crate) run: String,
    /// The command's name
    pub(crate) command: String,
    /// Its fields
    #[arg(value_name = "NAME=JSON")]
    pub(crate) fields: Vec<String>,
    #[command(flatten)]
    pub(crate) runs: Runs,
    #[command(flatten)]
    pub(crate) remote: Remote,
}

const EXIT_CODES: &str = "\
Exit codes:
  0  the machine ended by its outcome 0
  1  the machine could not be loaded, or the run could not begin
  2  wrong usage
  3  it ended by another outcome of its own
  4  it was aborted: an error left the root state
  5  it was preempted or stopped
  6  the time given by --timeout was over
  7  the Python process that ran it died";

/// What a run writes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Output {
    /// For people: a live view on a terminal, plain lines elsewhere
    Text,
    /// One JSON object a line, `finished` last
    Json,
}

/// List every problem of a machine, with the way out.
///
/// Exits with 1 if there is an error. Scripts are read by the chosen Python, never run.
#[derive(Debug, Args)]
pub(crate) struct Check {
    /// Folder of the machine (or a file in it)
    pub(crate) path: PathBuf,
    #[command(flatten)]
    pub(crate) libraries: Libraries,
    #[command(flatten)]
    pub(crate) python: Python,
    /// How problems are written
    #[arg(long, value_enum, default_value_t = CheckFormat::Text)]
    pub(crate) format: CheckFormat,
}

/// How problems are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum CheckFormat {
    /// For people
    Text,
    /// One JSON object a line
    Json,
}

/// Print a machine.
#[derive(Debug, Args)]
pub(crate) struct Show {
    /// Folder of the machine (or a file in it)
    pub(crate) path: PathBuf,
    #[command(flatten)]
    pub(crate) libraries: Libraries,
    /// How it is printed
    #[arg(long, value_enum, default_value_t = ShowFormat::Tree)]
    pub(crate) format: ShowFormat,
}

/// How a machine is printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ShowFormat {
    /// An indented tree for people
    Tree,
    /// The text notation: everything but scripts and layout, for tests, mails and bug reports
    TextNotation,
    /// One JSON document
    Json,
    /// A graph for Graphviz
    Dot,
    /// A state diagram for Mermaid
    Mermaid,
}

/// Rewrite a machine in the current file format.
#[derive(Debug, Args)]
pub(crate) struct Fmt {
    /// Folder of the machine (or a file in it)
    pub(crate) path: PathBuf,
    /// Write nothing; exit with 1 if something would change
    #[arg(long)]
    pub(crate) check: bool,
}

/// Make a new machine.
#[derive(Debug, Args)]
pub(crate) struct New {
    /// Folder to make; its name becomes the machine's
    pub(crate) path: PathBuf,
    /// What to begin with
    #[arg(long, value_parser = template_names(), default_value = "hello")]
    pub(crate) template: String,
    /// Number of states, for templates that come in sizes
    #[arg(long)]
    pub(crate) states: Option<usize>,
}

fn template_names() -> PossibleValuesParser {
    PossibleValuesParser::new(
        templates::ALL
            .iter()
            .map(|template| clap::builder::PossibleValue::new(template.name).help(template.about)),
    )
}

/// Print the completions of a shell.
#[derive(Debug, Args)]
pub(crate) struct Completions {
    /// Which shell
    pub(crate) shell: clap_complete::Shell,
}

/// Print the manual page, for `man -l -`.
#[derive(Debug, Args)]
pub(crate) struct Man {}

/// Where libraries are found.
#[derive(Debug, Args)]
pub(crate) struct Libraries {
    /// Folder of libraries and the name that machines know it by (repeat for more)
    #[arg(long = "library-path", value_name = "NAME=DIR")]
    pub(crate) roots: Vec<String>,
    /// RAFCON's config.yaml, or the folder that holds it; it is read, never written
    #[arg(long, value_name = "PATH")]
    pub(crate) config: Option<PathBuf>,
}

/// Where the folders of runs lie.
#[derive(Debug, Args)]
pub(crate) struct Runs {
    /// Folder that keeps the runs; else `rafcon/runs` in the user's folder for program state
    #[arg(long, value_name = "DIR", env = "RAFCON_RUNS")]
    pub(crate) runs: Option<PathBuf>,
}

/// Which Python runs the scripts.
#[derive(Debug, Args)]
pub(crate) struct Python {
    /// Interpreter for the scripts; else the active virtual environment's, else `python3` on the PATH
    #[arg(long, value_name = "PROGRAM", env = "RAFCON_PYTHON")]
    pub(crate) python: Option<PathBuf>,
}
