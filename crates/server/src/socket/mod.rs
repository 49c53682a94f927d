//! The WebSocket: subscriptions to histories and to the latest truth, commands and edits, over one connection.
//!
//! Knows frames, pace and room. Must never slow a runner down, nor hold more of what a client does not take than a page.

mod feed;
mod outbox;
mod pulse;
mod session;
mod status;
mod words;
