//! Subjects of commits: `area: imperative`, at most 65 characters.

use crate::process;

/// Maximum number of characters of a subject.
const LENGTH_MAX: usize = 65;

/// Lists the malformed subjects since a commit. They can no longer be changed, so the check does not fail.
#[expect(clippy::print_stderr, reason = "a hint to the developer")]
pub(super) fn show(since: &str) {
    let mut git = process::command("git");
    git.args(["log", "--no-merges", "--format=%h %s", &format!("{since}..HEAD"), "--"]);
    git.stderr(std::process::Stdio::null());
    let Ok(log) = process::text(&mut git) else {
        eprintln!("note: this clone does not have the commit {since}: subjects were not checked");
        return;
    };
    for line in log.lines() {
        let subject = line.split_once(' ').map_or("", |(_, subject)| subject);
        if !is_subject(subject) {
            eprintln!(
                "note: a subject is `area: imperative`, at most {LENGTH_MAX} characters: {line}"
            );
        }
    }
}

fn is_subject(subject: &str) -> bool {
    let Some((area, rest)) = subject.split_once(": ") else { return false };
    let is_area = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || "_-/., ".contains(c);
    let starts_low = rest.chars().next().is_some_and(|c| !c.is_uppercase());
    !area.is_empty()
        && area.chars().all(is_area)
        && starts_low
        && subject.chars().count() <= LENGTH_MAX
        && !subject.ends_with('.')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_subject_has_an_area_and_is_short() {
        assert!(is_subject("link: number runs per pairing"));
        assert!(is_subject("docs/guide: say how a proxy is set up"));
        assert!(!is_subject("Runs of a robot are numbered now"));
        assert!(!is_subject("link: Runs of a robot are numbered now"));
        assert!(!is_subject("link: number runs."));
        let long = format!("link: {}", "a".repeat(LENGTH_MAX));
        assert!(!is_subject(&long));
    }
}
