//! Building, testing, demo set-up.
fn main() {}
