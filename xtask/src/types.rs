//! Files generated from the server's types: the `OpenAPI` description and the TypeScript types of the web application.
//! Knows the generating programs and the locations of their outputs.

use std::path::Path;

use anyhow::{Context as _, Result, bail};
use serde_json::Value;

use crate::{process, workspace};

/// Options of `cargo xtask types`.
#[derive(clap::Args, Clone, Copy)]
pub(crate) struct TypesOptions {
    /// Change nothing; fail if a file is outdated.
    #[arg(long)]
    check: bool,
}

/// A file and the example that prints it.
struct Generated {
    file: &'static str,
    package: &'static str,
    example: &'static str,
    features: &'static [&'static str],
}

const TYPESCRIPT: Generated = Generated {
    file: "web/src/model/generated/protocol.ts",
    package: "rafcon-protocol",
    example: "typescript",
    features: &["--features", "schema"],
};

const OPENAPI: Generated = Generated {
    file: "docs/openapi.json",
    package: "rafcon-server",
    example: "openapi",
    features: &[],
};

/// Writes the files, or checks them.
pub(crate) fn run(options: TypesOptions) -> Result<()> {
    let texts = [TYPESCRIPT.text()?, OPENAPI.text()?];
    if options.check { check(texts) } else { write(texts) }
}

/// Checks the files with the programs of a full debug build. Cargo would compile most crates again for them, with other
/// features.
pub(crate) fn check_by_built() -> Result<()> {
    check([TYPESCRIPT.text_by_built()?, OPENAPI.text_by_built()?])
}

fn check([types, description]: [String; 2]) -> Result<()> {
    compare(&types, &description)?;
    TYPESCRIPT.check(&types)?;
    OPENAPI.check(&description)
}

fn write([types, description]: [String; 2]) -> Result<()> {
    compare(&types, &description)?;
    TYPESCRIPT.write(&types)?;
    OPENAPI.write(&description)
}

impl Generated {
    fn text(&self) -> Result<String> {
        let run = ["run", "--quiet", "--package", self.package, "--example", self.example];
        process::text(process::cargo().args(run).args(self.features))
    }

    fn text_by_built(&self) -> Result<String> {
        let program = workspace::target()?.join("debug/examples").join(self.example);
        process::text(&mut process::command(program))
    }

    fn check(&self, text: &str) -> Result<()> {
        let found = std::fs::read_to_string(workspace::path(self.file)).unwrap_or_default();
        if found != text {
            bail!("{} does not match the crates: run `cargo xtask types`", self.file);
        }
        Ok(())
    }

    fn write(&self, text: &str) -> Result<()> {
        let file = workspace::path(self.file);
        let folder = file.parent().unwrap_or(Path::new(""));
        let written = std::fs::create_dir_all(folder).and_then(|()| std::fs::write(&file, text));
        written.with_context(|| format!("cannot write {}", file.display()))
    }
}

/// Checks that every schema of the description is also a type, to detect entries missing from the list of types.
fn compare(types: &str, description: &str) -> Result<()> {
    let description: Value =
        serde_json::from_str(description).context("the description is no JSON")?;
    let words = description["components"]["schemas"].as_object().context("it has no schemas")?;
    let is_missing = |word: &&String| !types.contains(&format!("export type {word} "));
    let missing = words.keys().filter(is_missing).map(String::as_str).collect::<Vec<_>>();
    if !missing.is_empty() {
        bail!(
            "no TypeScript for {}: add it to crates/protocol/examples/typescript.rs",
            missing.join(", ")
        );
    }
    Ok(())
}
