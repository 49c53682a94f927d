//! Checks for forbidden words: locations that exist on one machine only.

use anyhow::Result;

use crate::workspace;

/// Each is written in two halves, so that this list does not match itself.
const FORBIDDEN: [(&str, &str); 4] =
    [("/wo", "rk/"), ("shared/", "docs"), ("shared/", "conformance"), ("reference-", "core.md")];

/// Checks every text file of the repository.
pub(super) fn check() -> Result<Vec<String>> {
    let mut findings = Vec::new();
    for file in workspace::files("*")? {
        let Ok(text) = std::fs::read_to_string(workspace::path(&file)) else { continue };
        for word in words_in(&text) {
            findings.push(format!(
                "{}: mentions `{word}`, which a reader does not have",
                file.display()
            ));
        }
    }
    Ok(findings)
}

fn words_in(text: &str) -> Vec<String> {
    FORBIDDEN
        .iter()
        .map(|(head, tail)| format!("{head}{tail}"))
        .filter(|word| text.contains(word.as_str()))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_of_one_machine_is_found() {
        let path = ["/wo", "rk/main"].concat();
        assert_eq!(words_in(&format!("see {path}")).len(), 1);
        assert!(words_in("see docs/format.md").is_empty());
    }
}
