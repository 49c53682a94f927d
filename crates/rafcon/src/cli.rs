//! The commands and options of the command line, as clap parses them. Each command checks what they mean.

mod kept;
mod link;
mod plan;
mod remote;
mod serve;

pub(crate) use kept::{
    Compare, Export, ExportFormat, History, KeptRun, ListRuns, Log, LogLevel, Replay,
};
pub(crate) use link::{
    CommandList, Contacts, Link, LinkProfile, LinkStatus, ListFormat, Machines, Pair, Station,
};
pub(crate) use plan::{Plan, Then};
pub(crate) use remote::{Access, Again, Control, Fetch, KeptRemote, Login, Remote, Wanted};
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
    Again(Again),
    Runs(ListRuns),
    History(History),
    Log(Log),
    Replay(Replay),
    Compare(Compare),
    Export(Export),
    Serve(Serve),
    Station(Station),
    Pair(Pair),
    Link(LinkStatus),
    Contacts(Contacts),
    Machines(Machines),
    Commands(CommandList),
    Fetch(Fetch),
    User(User),
    Login(Login),
    Control(Control),
    Check(Check),
    Plan(Plan),
    Show(Show),
    Fmt(Fmt),
    New(New),
    Completions(Completions),
    Man(Man),
}

/// Run a machine until it ends.
///
/// A terminal shows the active states live; without one, or with `--output json`, each event is one line.
/// Ctrl-C and SIGTERM stop the machine in an orderly way. A second Ctrl-C, more than two seconds after the first, kills it; what
/// comes earlier, and every further SIGTERM, repeats the request to stop. Ctrl-Z suspends the view and a terminal that
/// hangs up ends it; the run continues in both cases. Scripts can read a piped input, but not the keyboard.
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct Run {
    /// Folder of the machine, or a file in it; with --server the project and the folder in it, such as `robots/pick`
    pub(crate) path: PathBuf,
    /// Start at this state: the ids from the root down, joined by `/`
    #[arg(long, value_name = "STATE_PATH")]
    pub(crate) start_from: Option<String>,
    /// Value for an input port of the root, as JSON (repeat for more)
    #[arg(long = "input", value_name = "NAME=JSON")]
    pub(crate) inputs: Vec<String>,
    /// Global variable to set before the first state runs, as JSON (repeat for more)
    #[arg(long = "global", value_name = "NAME=JSON")]
    pub(crate) globals: Vec<String>,
    #[command(flatten)]
    pub(crate) libraries: Libraries,
    #[command(flatten)]
    pub(crate) python: Python,
    /// Format of the standard output
    #[arg(long, value_enum, default_value_t = Output::Text)]
    pub(crate) output: Output,
    /// Stop the machine this many seconds after the start of this program, and kill it if it does not end
    #[arg(long, value_name = "SECONDS")]
    pub(crate) timeout: Option<f64>,
    #[command(flatten)]
    pub(crate) runs: Runs,
    #[command(flatten)]
    pub(crate) keeping: Keeping,
    /// Pause before the first state, to step or to set breakpoints first
    #[arg(long)]
    pub(crate) hold: bool,
    /// Breakpoint before this state, given by path or name; `after` pauses after it, and `if` adds a condition in Python
    /// over `inputs`, `outputs`, `scoped`, `outcome` and `gvm` (repeat for more)
    #[arg(long = "break", value_name = "STATE [after] [if CONDITION]")]
    pub(crate) breakpoints: Vec<String>,
    /// Have this robot of the station (`--server`) start the machine, which lies in a project of the robot
    #[arg(long, value_name = "NAME", requires = "server")]
    pub(crate) robot: Option<String>,
    /// Repeat the request to the robot with this id, whose answer did not come, instead of making another
    #[arg(long, value_name = "ID", requires = "robot")]
    pub(crate) request: Option<String>,
    #[command(flatten)]
    pub(crate) remote: Remote,
}

/// What the journal of a run keeps, and what happens when its runner dies.
#[derive(Debug, Args)]
pub(crate) struct Keeping {
    /// How much of the run is recorded
    #[arg(long, value_enum, default_value_t = Level::Full)]
    pub(crate) keep: Level,
    /// Start each script only when everything before it is safe from a power cut
    #[arg(long)]
    pub(crate) strict: bool,
    /// Maximum size of the run's journal; beyond it, old details are deleted
    #[arg(long, value_name = "MEGABYTES")]
    pub(crate) keep_max: Option<u64>,
    /// What to do with the interrupted scripts if the runner dies; the default is `on_crash` in the semantic data of the
    /// root state, or `ask`
    #[arg(long, value_enum)]
    pub(crate) on_crash: Option<OnCrash>,
}

/// Level of detail in the record of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Level {
    /// Everything; the run can be replayed and resumed
    Full,
    /// States, outcomes, commands and the log, without values
    Status,
    /// Nothing at all
    Off,
}

/// Policy for scripts that a crash interrupted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum OnCrash {
    /// Wait until a user decides
    Ask,
    /// Abort them; the machine's recovery transitions take over
    Abort,
    /// Run them again, with the same inputs
    Restart,
}

/// Resume a run whose runner died.
///
/// The run continues in its own folder, with its machine, its data and its history.
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct Resume {
    /// The run: its id or the start of the id, its folder, or `last`
    pub(crate) run: String,
    /// What to do with the scripts that were interrupted
    #[arg(long, value_enum, default_value_t = OnCrash::Ask)]
    pub(crate) policy: OnCrash,
    /// Continue from this `entered` event of the history instead, and pause there
    #[arg(long, value_name = "SEQUENCE")]
    pub(crate) from: Option<u64>,
    #[command(flatten)]
    pub(crate) runs: Runs,
    #[command(flatten)]
    pub(crate) python: Python,
    /// Format of the standard output
    #[arg(long, value_enum, default_value_t = Output::Text)]
    pub(crate) output: Output,
    /// Stop the machine after this time, and kill it if it does not end
    #[arg(long, value_name = "SECONDS")]
    pub(crate) timeout: Option<f64>,
    #[command(flatten)]
    pub(crate) remote: Remote,
}

/// Join an active run: watch it, step it, answer its questions.
///
/// `q` or Ctrl-C leaves; the run continues. `?` lists the keys.
#[derive(Debug, Args)]
pub(crate) struct Attach {
    /// The run: its id or the start of the id, its folder, or `last`
    #[arg(default_value = "last")]
    pub(crate) run: String,
    #[command(flatten)]
    pub(crate) runs: Runs,
    /// Format of the standard output
    #[arg(long, value_enum, default_value_t = Output::Text)]
    pub(crate) output: Output,
    /// Start with this event of the history instead of now
    #[arg(long, value_name = "SEQUENCE", default_value_t = 0)]
    pub(crate) from: u64,
    #[command(flatten)]
    pub(crate) remote: Remote,
}

/// Send one command to an active run, and print the answer.
///
/// Write the name of the command, then its fields as NAME=JSON (text needs no quotes), such as
/// `rafcon tell last step_into` or `rafcon tell last force_outcome path=ROOT/SCAN outcome=0`.
/// docs/protocol.md lists the commands. The exit code is 1 if the run refuses the command or it came too late, and 9 if it is not known
/// whether a robot behind a link carried it out.
#[derive(Debug, Args)]
pub(crate) struct Tell {
    /// The run: its id or the start of the id, its folder, or `last`
    pub(crate) run: String,
    /// Name of the command
    pub(crate) command: String,
    /// Fields of the command
    #[arg(value_name = "NAME=JSON")]
    pub(crate) fields: Vec<String>,
    /// Carry it out so many seconds from now, not earlier; for runs of robots behind a link only
    #[arg(long = "in", value_name = "SECONDS")]
    pub(crate) wait_s: Option<u64>,
    /// Expiry in seconds from now. Default: 10 s; over a link, two round trips and the uncertainty of the robot's clock more; a stop or
    /// kill does not expire
    #[arg(long = "expires-in", value_name = "SECONDS")]
    pub(crate) expires_in_s: Option<u64>,
    #[command(flatten)]
    pub(crate) runs: Runs,
    #[command(flatten)]
    pub(crate) remote: Remote,
}

const EXIT_CODES: &str = "\
Exit codes:
  0  the machine ended with its outcome 0
  1  the machine could not be loaded, the run could not start, or it could only wait and no terminal showed it
  2  wrong usage
  3  the machine ended with another outcome of its own
  4  the machine was aborted: an error left the root state
  5  the machine was preempted or stopped: it ended by itself, with its recovery
  6  the time limit of --timeout expired, and the machine stopped by itself
  7  the Python process of the run died
  8  the run was killed, by a second Ctrl-C or because it did not stop in time: no recovery ran";

/// Format of a run's output.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Output {
    /// For people: a live view on a terminal, plain lines elsewhere
    Text,
    /// One JSON object per line, `finished` last
    Json,
}

/// List every problem of a machine, and how to fix it.
///
/// The exit code is 1 if there is an error. The chosen Python parses the scripts but never runs them.
#[derive(Debug, Args)]
pub(crate) struct Check {
    /// Folder of the machine, or a file in it
    pub(crate) path: PathBuf,
    #[command(flatten)]
    pub(crate) libraries: Libraries,
    #[command(flatten)]
    pub(crate) python: Python,
    /// Output format
    #[arg(long, value_enum, default_value_t = CheckFormat::Text)]
    pub(crate) format: CheckFormat,
}

/// Output format of the problems.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum CheckFormat {
    /// For people
    Text,
    /// One JSON object per line
    Json,
}

/// Print a machine.
#[derive(Debug, Args)]
pub(crate) struct Show {
    /// Folder of the machine, or a file in it
    pub(crate) path: PathBuf,
    #[command(flatten)]
    pub(crate) libraries: Libraries,
    /// Output format
    #[arg(long, value_enum, default_value_t = ShowFormat::Tree)]
    pub(crate) format: ShowFormat,
}

/// Output format of a machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ShowFormat {
    /// An indented tree for people
    Tree,
    /// Text notation: everything except scripts and layout, for tests, mails and bug reports
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
    /// Folder of the machine, or a file in it
    pub(crate) path: PathBuf,
    /// Only check: write nothing, and exit with 1 if a file would change
    #[arg(long)]
    pub(crate) check: bool,
}

/// Create a machine.
#[derive(Debug, Args)]
pub(crate) struct New {
    /// Folder to create; the machine gets its name
    pub(crate) path: PathBuf,
    /// Template of the machine
    #[arg(long, value_parser = template_names(), default_value = "hello")]
    pub(crate) template: String,
    /// Number of states, for templates that have a size
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
    /// The shell
    pub(crate) shell: clap_complete::Shell,
}

/// Print the manual page, for `man -l -`.
#[derive(Debug, Args)]
pub(crate) struct Man {}

/// Where libraries are found.
#[derive(Debug, Args)]
pub(crate) struct Libraries {
    /// Folder of libraries, and the name that machines use for it (repeat for more)
    #[arg(long = "library-path", value_name = "NAME=DIR")]
    pub(crate) roots: Vec<String>,
    /// RAFCON's config.yaml, or its folder; read but never written
    #[arg(long, value_name = "PATH")]
    pub(crate) config: Option<PathBuf>,
}

/// Where the folders of runs lie.
#[derive(Debug, Args)]
pub(crate) struct Runs {
    /// Folder of the runs; the default is `rafcon/runs` in the user's folder for program state
    #[arg(long, value_name = "DIR", env = "RAFCON_RUNS")]
    pub(crate) runs: Option<PathBuf>,
}

/// Which Python runs the scripts.
#[derive(Debug, Args)]
pub(crate) struct Python {
    /// Interpreter for the scripts; the default is that of the active virtual environment, or `python3` on the PATH
    #[arg(long, value_name = "PROGRAM", env = "RAFCON_PYTHON")]
    pub(crate) python: Option<PathBuf>,
}
