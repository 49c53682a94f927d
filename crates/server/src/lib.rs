//! The server: projects, open machines, runs and people behind one HTTP and WebSocket interface.
//!
//! Knows rights, open machines and active runs. Does not know the inside of the engine or of a runner: a runner is a process
//! that it starts or joins and speaks the protocol with. [`access::ROUTES`] lists the routes and their rights; `docs/api.md` is
//! the guide for authors of clients.

pub mod access;
mod change_counters;
mod child;
mod description;
mod document_text;
mod documents;
mod extract;
mod failure;
mod gate;
mod history;
mod listen;
mod log;
mod page;
mod page_files;
mod plans;
mod projects;
mod python;
mod router;
mod runs;
pub mod settings;
mod socket;
mod state;
mod watch;

pub use failure::{Failure, Reason};
pub use listen::{AddressFile, ServeError, Server, TlsError, serve, tls_config};
pub use page_files::PageFiles;
pub use projects::project_ids;
pub use router::{openapi, router};
pub use runs::RunAuthority;
pub use settings::{
    CommandListFault, ContactsFault, MachinesFault, NotTaken, Robots, RunValue, Settings,
};
pub use state::{ServerState, ServerStateError};
