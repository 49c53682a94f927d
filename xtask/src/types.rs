//! What is generated from the server's words: its `OpenAPI` description and the TypeScript types of the web application.
//! Knows which program prints what and where it belongs.

use std::path::Path;

use anyhow::{Context as _, Result, bail};
use serde_json::Value;

use crate::{process, workspace};

/// What `cargo xtask types` can be asked for.
#[derive(clap::Args, Clone, Copy, Default)]
pub(crate) struct TypesOptions {
    /// Change nothing; fail if a file is not what it should be.
    #[arg(long)]
    check: bool,
}

impl TypesOptions {
    /// To check the files.
    pub(crate) const CHECK: Self = Self { check: true };
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
    let (types, description) = (TYPESCRIPT.text()?, OPENAPI.text()?);
    compare(&types, &description)?;
    for (generated, text) in [(TYPESCRIPT, types), (OPENAPI, description)] {
        if options.check {
            generated.check(&text)?;
        } else {
            generated.write(&text)?;
        }
    }
    Ok(())
}

impl Generated {
    fn text(&self) -> Result<String> {
        let run = ["run", "--quiet", "--package", self.package, "--example", self.example];
        process::text(process::cargo().args(run).args(self.features))
    }

    fn check(&self, text: &str) -> Result<()> {
        let found = std::fs::read_to_string(workspace::path(self.file)).unwrap_or_default();
        if found != text {
            bail!("{} is not what the crates say now: run `cargo xtask types`", self.file);
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

/// Every word of the description is a type as well: one that is forgotten in the list of types is found here.
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
