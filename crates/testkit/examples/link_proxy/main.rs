//! A bad network between a robot and a station: `cargo xtask link-proxy`.
//!
//! On loopback it carries datagrams: robots send to `--listen`, the station listens at `--to`; with `--tcp`
//! connections of TCP. With `--tun` it is a network of two
//! hosts, each in a namespace of its own with a real kernel, and carries whatever packets they send. Lines on standard input change
//! it while it carries ([`path`]); `--page` shows a page that does the same.

mod carry;
mod ends;
mod options;
mod page;
mod path;
mod recording;
mod tcp;
mod tun;

use options::{Options, USAGE};
use std::process::ExitCode;

#[expect(clippy::print_stderr, reason = "this is a command-line program")]
fn main() -> ExitCode {
    let options = match Options::read(std::env::args().skip(1)) {
        Ok(options) => options,
        Err(why) => {
            eprintln!("error: {why}\n{USAGE}");
            return ExitCode::from(2);
        }
    };
    match carry::carry(&options) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
