//! Checks that relative links in the documents have a target, including the heading.

use std::path::{Path, PathBuf};

use anyhow::Result;

use crate::workspace;

/// Checks every Markdown file of the repository.
pub(super) fn check() -> Result<Vec<String>> {
    let mut findings = Vec::new();
    for file in workspace::files("*.md")? {
        let text = workspace::read(&file)?;
        for link in links(&text)
            .into_iter()
            .filter(|link| !link.contains("://") && !link.starts_with("mailto:"))
        {
            if !resolves(&file, link) {
                findings.push(format!("{}: the link `{link}` leads nowhere", file.display()));
            }
        }
    }
    Ok(findings)
}

/// The targets of `[text](target)` outside code.
fn links(text: &str) -> Vec<&str> {
    let mut fenced = false;
    let mut found = Vec::new();
    for line in text.lines() {
        fenced ^= line.trim_start().starts_with("```");
        if !fenced {
            let parts = line.split('`').step_by(2).flat_map(|part| part.split("](").skip(1));
            found.extend(parts.filter_map(|rest| rest.split_once(')')).map(|(target, _)| target));
        }
    }
    found
}

fn resolves(from: &Path, link: &str) -> bool {
    let (target, heading) = link.split_once('#').unwrap_or((link, ""));
    let folder = from.parent().unwrap_or(Path::new(""));
    let file = if target.is_empty() { from.to_path_buf() } else { folder.join(target) };
    workspace::path(&file).exists() && (heading.is_empty() || has_heading(&file, heading))
}

fn has_heading(file: &PathBuf, heading: &str) -> bool {
    let text = workspace::read(file).unwrap_or_default();
    text.lines().filter(|line| line.starts_with('#')).any(|line| anchor(line) == heading)
}

/// The anchor of a heading on hosting sites.
fn anchor(heading: &str) -> String {
    let text = heading.trim_start_matches('#').trim().to_lowercase();
    let kept = text.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_are_found_outside_code_only() {
        let text = "See [a](docs/a.md#b) and `[x](y)`.\n```\n[c](d)\n```\n![picture](p.svg)\n";
        assert_eq!(links(text), ["docs/a.md#b", "p.svg"]);
    }

    #[test]
    fn a_heading_becomes_its_anchor() {
        assert_eq!(anchor("## 2. What `rafcon run` prints"), "2-what-rafcon-run-prints");
    }
}
