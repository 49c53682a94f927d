//! Signals of the system to this process: an orderly stop, and a terminal that goes away.

use crate::Scripts;
use crate::drive::driver::Driver;
use rafcon_engine::Input;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::{Handle, Signals};
use std::io;
use std::sync::Arc;

/// Takes the signals over from now on. The second value ends [`serve`].
pub(crate) fn take_over() -> io::Result<(Signals, Handle)> {
    let signals = Signals::new([SIGINT, SIGTERM, SIGHUP])?;
    let handle = signals.handle();
    Ok((signals, handle))
}

/// Stops the run at each request, until the handle is closed. A terminal that hangs up means nothing to a run.
pub(crate) fn serve<S: Scripts>(driver: &Arc<Driver<S>>, mut signals: Signals) {
    for signal in signals.forever() {
        if signal != SIGHUP {
            driver.reach_for_stop(|_why| ());
            // Refused when the run is over or has not begun, and then there is nothing to stop.
            drop(driver.command(Input::Stop));
        }
    }
}
