//! Plans in words.

use crate::view::{counted, harmless};
use rafcon_protocol::api::{PlanDomain, PlanEnd, PlanEvent, PlanFinding, PlanFound, PlanStep};
use std::fmt::Write as _;

/// The planning domain of the skills.
pub(super) fn domain(domain: &PlanDomain) -> String {
    let skills =
        domain.skills.iter().map(|skill| format!("; {} is {}\n", skill.action, skill.library));
    let skills: String = skills.collect();
    harmless_lines(&format!("{}{skills}{}\n", findings(&domain.findings), domain.pddl))
}

/// The best plan, and the end of planning.
pub(super) fn answer(best: Option<&PlanFound>, last: &PlanEvent) -> String {
    let mut text = String::new();
    let (head, end) = match last {
        PlanEvent::Found(_) | PlanEvent::Done(_) => ("", None),
        PlanEvent::Impossible(end) => ("there is no plan: ", Some(end)),
        PlanEvent::NotFound(end) | PlanEvent::Failed(end) => ("no plan: ", Some(end)),
        PlanEvent::Cancelled(end) => ("cancelled: ", Some(end)),
        PlanEvent::Refused(refused) => {
            text += &findings(&refused.findings);
            text += "no plan: first repair the errors above\n";
            ("", None)
        }
    };
    if let Some(PlanEnd { reason, findings: all, .. }) = end {
        text += &findings(all);
        let _infallible = writeln!(text, "{head}{reason}");
    }
    if let Some(found) = best {
        text += &plan(found);
    }
    harmless_lines(&text)
}

fn findings(all: &[PlanFinding]) -> String {
    let line = |finding: &PlanFinding| {
        let level = if finding.is_error { "error" } else { "warning" };
        let place = finding.libraries.iter().map(|library| format!("{library}: "));
        format!("{level}: {}{}\n", place.collect::<String>(), finding.text)
    };
    all.iter().map(line).collect()
}

fn plan(found: &PlanFound) -> String {
    let mut text = findings(&found.findings);
    for (index, step) in found.steps.iter().enumerate() {
        let time = match step.duration {
            Some(duration) => format!("  from {} for {}", short(step.start), short(duration)),
            None => String::new(),
        };
        let _infallible = writeln!(text, "{:>4} {}{time}", index + 1, step.title);
        text += &reasons(step);
    }
    let count = counted(found.steps.len() as u64, "step");
    let times =
        if found.temporal { format!(", takes {}", short(found.makespan)) } else { String::new() };
    let lost = if found.lost > 0.0 {
        format!(", its machine {} longer", short(found.lost))
    } else {
        String::new()
    };
    let _infallible = writeln!(
        text,
        "{count}{times}{lost}; valid; found by {} in {} ms",
        found.engine, found.after_ms
    );
    text
}

/// Engines round to thousandths.
fn short(time: f64) -> f64 {
    (time * 1000.0).round() / 1000.0
}

fn reasons(step: &PlanStep) -> String {
    let mut text = String::new();
    let needs = step.needs.iter().map(|need| match need.from {
        Some(from) => format!("{} from {}", need.fact, from + 1),
        None => need.fact.clone(),
    });
    let brings = step.brings.iter().map(|gain| {
        let steps = gain.steps.iter().map(|step| (step + 1).to_string());
        let users: Vec<_> = steps.chain(gain.goal.then(|| "the goal".to_owned())).collect();
        format!("{} for {}", gain.fact, users.join(", "))
    });
    for (word, all) in [("needs", needs.collect::<Vec<_>>()), ("brings", brings.collect())] {
        if !all.is_empty() {
            let _infallible = writeln!(text, "       {word} {}", all.join(", "));
        }
    }
    text
}

/// Removes control characters, because texts of libraries and engines may confuse a terminal.
fn harmless_lines(text: &str) -> String {
    text.lines().map(|line| harmless(line) + "\n").collect()
}
