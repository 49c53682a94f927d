//! Retired identifiers, and parameters that are tuples.

use std::sync::LazyLock;

use regex::Regex;

use super::Hit;
use super::places::Language;

/// Retired in Rust, each with its replacement.
const RUST: [(&str, &str); 24] = [
    ("ink", "writer"),
    ("crew", "worker_pool"),
    ("company", "viewers"),
    ("guest", "viewer"),
    ("guests", "viewers"),
    ("spot", "stop_point"),
    ("inquiry", "breakpoint_scan"),
    ("heed", "handle"),
    ("hear_disk", "on_disk_event"),
    ("stands", "snapshot"),
    ("RunStands", "ReportedRunState"),
    ("StationWord", "StationRequest"),
    ("GivenWord", "PendingRequest"),
    ("OpenWords", "PendingRequests"),
    ("Had", "CompletedRuns"),
    ("Trouble", "KeepError"),
    ("ValueDesk", "ValueFetchBroker"),
    ("Wish", "WatchSubscription, PlanRequest or UserAction"),
    ("Later", "ScheduledCommands"),
    ("Turn", "TransmitContext"),
    ("look_at", "next_scan_at"),
    ("keep_at", "next_save_at"),
    ("remains", "crash_artifacts"),
    ("surroundings", "environment"),
];

/// Retired in the page.
const PAGE: [(&str, &str); 25] = [
    ("told", "received or announced"),
    ("said", "received or announced"),
    ("tellMishaps", "reportErrors"),
    ("mishaps", "errors"),
    ("wearTheme", "applyTheme"),
    ("hearBrowser", "onNetworkBack"),
    ("comeTo", "elapsedWhenLastHeard"),
    ("Following", "MachineFollower"),
    ("Waits", "IdleTimeout"),
    ("keyed", "canvas_keys"),
    ("looks", "framing"),
    ("lit", "highlight"),
    ("few", "join_few"),
    ("loudest", "mostUrgent"),
    ("Happening", "JournalEntry"),
    ("Extras", "RunOverlay"),
    ("Door", "AuthGate"),
    ("Inside", "Workspace"),
    ("Middle", "CanvasArea"),
    ("Centre", "CanvasArea"),
    ("Twice", "ConfirmButton"),
    ("Once", "ActionButton"),
    ("Stands", "StatusLine"),
    ("Came", "Age"),
    ("Wish", "WatchSubscription, PlanRequest or UserAction"),
];

/// Uses of retired identifiers outside comments and literals.
pub(super) fn retired(text: &str, language: Language) -> Vec<Hit> {
    static IN_RUST: LazyLock<Option<Regex>> = LazyLock::new(|| pattern(&RUST));
    static IN_PAGE: LazyLock<Option<Regex>> = LazyLock::new(|| pattern(&PAGE));
    let (names, found) = match language {
        Language::Rust => (&RUST[..], &*IN_RUST),
        Language::TypeScript => (&PAGE[..], &*IN_PAGE),
        Language::Python | Language::Markdown => return Vec::new(),
    };
    let Some(found) = found else { return Vec::new() };
    let mut hits = Vec::new();
    for (at, line) in text.lines().enumerate() {
        let code = code_of(line);
        for name in found.find_iter(&code) {
            let name = name.as_str();
            let new = names.iter().find(|(old, _)| *old == name).map_or("another", |(_, new)| new);
            let text = format!("`{name}` became {new}");
            hits.push(Hit { measure: "retired name", line: at + 1, text });
        }
    }
    hits
}

fn pattern(names: &[(&str, &str)]) -> Option<Regex> {
    let names: Vec<_> = names.iter().map(|(old, _)| *old).collect();
    Regex::new(&format!(r"\b(?:{})\b", names.join("|"))).ok()
}

/// A line without its comment and its literals.
fn code_of(line: &str) -> String {
    static LITERAL: LazyLock<Option<Regex>> = LazyLock::new(|| {
        Regex::new(r#""(?:[^"\\]|\\.)*"|`(?:[^`\\]|\\.)*`|//.*$|^\s*(?:\*|/\*).*$"#).ok()
    });
    LITERAL.as_ref().map_or_else(String::new, |literal| literal.replace_all(line, "").into_owned())
}

/// Parameters of functions that are tuples, outside of comments and literals.
pub(super) fn tuple_parameters(text: &str) -> Vec<Hit> {
    static TUPLE: LazyLock<Option<Regex>> =
        LazyLock::new(|| Regex::new(r"\((?:mut )?\w+(?:, (?:mut )?\w+)+\): &?(?:mut )?\(").ok());
    let Some(tuple) = &*TUPLE else { return Vec::new() };
    let lines = text.lines().enumerate().map(|(at, line)| (at + 1, code_of(line)));
    let lines = lines.filter(|(_, code)| !code.contains("let "));
    let found =
        lines.filter_map(|(line, code)| Some((line, tuple.find(&code)?.as_str().to_owned())));
    found.map(|(line, text)| Hit { measure: "tuple", line, text }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn retired_names_are_found_in_code_only() {
        let lines =
            |text, language| retired(text, language).iter().map(|hit| hit.line).collect::<Vec<_>>();
        let rust = "// ink\nlet ink = \"spot\";\nlet think = spot_on;\nuse a::Turn;\n";
        assert_eq!(lines(rust, Language::Rust), [2, 4]);
        assert_eq!(lines("const told = 1;\n<Door />\n", Language::TypeScript), [1, 2]);
    }

    #[test]
    fn tuple_parameters_are_told_from_bindings() {
        let text = "fn a((b, c): (u8, u8)) {\n    let (d, e): (u8, u8) = f;\n    (room, payload): (usize, &mut Vec<u8>),\n";
        let lines: Vec<_> = tuple_parameters(text).iter().map(|hit| hit.line).collect();
        assert_eq!(lines, [1, 3]);
        assert_eq!(tuple_parameters("let text =\n    \"fn a((b, c): (u8, u8))\";\n"), []);
    }
}
