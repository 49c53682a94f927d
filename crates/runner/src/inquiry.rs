//! What scripts may ask about the run that they are part of. Called on any thread, never while the engine is locked.

use crate::core::Core;
use crate::driver::Driver;
use crate::{Place, Scripts, tell};
use rafcon_engine::{Inspection, PathId};
use rafcon_model::Machine;
use rafcon_protocol::{Event, LogLevel, Stream};
use std::sync::Arc;

impl<S: Scripts> Driver<S> {
    /// The place with this number, also if no state was entered there yet.
    pub fn place(&self, path: PathId) -> Option<Arc<Place>> {
        self.places().get(path).or_else(|| {
            let make = |core: &mut Core<S::Value>| {
                let node = core.engine.path_node(path)?;
                Some(Arc::clone(core.place_of(path, node)))
            };
            self.with_core(make)?
        })
    }

    /// The places of the states inside, in their order.
    pub fn children(&self, path: PathId) -> Vec<PathId> {
        self.with_core(|core| core.engine.child_places(path).to_vec()).unwrap_or_default()
    }

    /// What the state at this place holds; `None` if it is not active.
    pub fn inspect(&self, path: PathId) -> Option<Inspection<S::Value>> {
        self.with_core(|core| core.engine.inspect(path))?
    }

    /// The machine that is run now.
    pub fn machine(&self) -> Arc<Machine> {
        self.document().machine()
    }

    /// Notes a line down that a state wrote.
    pub fn log(&self, path: Option<PathId>, level: LogLevel, stream: Stream, message: String) {
        let path = path.and_then(|path| self.places().with(path, |place| place.text.to_string()));
        let event = Event::Log { path: path.unwrap_or_default(), level, stream, message };
        self.tell(event);
    }

    /// Notes an event down.
    pub(crate) fn tell(&self, event: Event) {
        self.recorder().push(self.clock().now_ns(), [tell::told(event)]);
    }
}
