//! Prints the `OpenAPI` description of the server; `cargo xtask types` keeps it in `docs/openapi.json`.
#![expect(clippy::print_stdout, reason = "its output is what it is for")]

fn main() -> Result<(), serde_json::Error> {
    println!("{}", rafcon_server::openapi().to_pretty_json()?);
    Ok(())
}
