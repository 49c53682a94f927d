//! A visit to a run at a server: the same as to one on this computer, but for the way there.

use super::guest::Guest;
use super::manners::AttachOptions;
use super::visit::{Visit, VisitEnd};
use crate::client::{Server, follow};
use crate::clock::Clock;
use crate::commands::remote;
use crate::environment::Environment;
use crate::event_queue::EventQueue;
use crate::view::View;
use anyhow::Result;
use rafcon_protocol::Join;
use std::sync::Arc;

/// What a visit to a run at a server needs.
pub(in crate::commands) struct RemoteAttach<'a> {
    pub(in crate::commands) server: &'a Arc<Server>,
    /// The run's id.
    pub(in crate::commands) run: &'a str,
    pub(in crate::commands) wires: EventQueue,
    pub(in crate::commands) view: Box<dyn View>,
    /// The first event that is told; 0: from now on.
    pub(in crate::commands) from: u64,
    pub(in crate::commands) manners: AttachOptions,
    pub(in crate::commands) environment: &'a Environment,
    pub(in crate::commands) clock: Clock,
}

impl RemoteAttach<'_> {
    /// Follows the run until it ends or the user leaves.
    pub(in crate::commands) fn until_the_end(self) -> Result<VisitEnd> {
        let Self { server, run, mut wires, view, from, manners, environment, clock } = self;
        let join = Join { from, every_event: view.every_event() };
        let line = Box::new(follow(server, run, &mut wires, clock)?);
        let visit = Visit::new(join, &environment.user, remote::unique("attach")?, manners);
        Guest { visit, view, line, clock }.until_the_end(&wires)
    }
}
