//! Plans and findings in the format for clients.

use rafcon_model::edit;
use rafcon_planner::pddl::{Signature, Typed};
use rafcon_planner::{Built, Finding, Plan, Pool, Reason, Structure, Task, explain};
use rafcon_protocol::api::{
    PlanDomain, PlanFinding, PlanFound, PlanGain, PlanNeed, PlanParameter, PlanSignature,
    PlanSkill, PlanStep,
};
use rafcon_protocol::document::Selection;
use std::sync::Arc;

pub(super) fn findings(all: &[Finding]) -> Vec<PlanFinding> {
    let finding = |finding: &Finding| PlanFinding {
        is_error: finding.is_error(),
        libraries: finding.libraries.iter().map(ToString::to_string).collect(),
        text: finding.text.clone(),
    };
    all.iter().map(finding).collect()
}

pub(super) fn domain(pool: &Pool) -> PlanDomain {
    let skill = |skill: &rafcon_planner::Skill| PlanSkill {
        library: skill.library.to_string(),
        title: skill.title.to_string(),
        action: skill.action.name.to_string(),
        description: skill.description.clone(),
        parameters: skill
            .action
            .parameters
            .iter()
            .map(|typed| {
                let port = skill.port(&typed.name).map(|port| port.name.to_string());
                PlanParameter { port, ..parameter(typed) }
            })
            .collect(),
        pddl: skill.action.to_string(),
    };
    let signatures = |all: &[Signature]| all.iter().map(signature).collect();
    PlanDomain {
        skills: pool.skills.iter().map(skill).collect(),
        types: pool
            .domain
            .types
            .iter()
            .map(|(child, parent)| (child.to_string(), parent.to_string()))
            .collect(),
        predicates: signatures(&pool.domain.predicates),
        functions: signatures(&pool.domain.functions),
        pddl: pool.domain.to_string(),
        findings: findings(&pool.findings),
    }
}

fn signature(signature: &Signature) -> PlanSignature {
    PlanSignature {
        name: signature.name.to_string(),
        arguments: signature.arguments.iter().map(parameter).collect(),
    }
}

fn parameter(typed: &Typed) -> PlanParameter {
    PlanParameter {
        name: typed.name.to_string(),
        types: typed.types.iter().map(ToString::to_string).collect(),
        port: None,
    }
}

/// A valid plan with its machine.
pub(super) struct Shown<'s> {
    pub(super) engine: &'s str,
    pub(super) after_ms: u64,
    pub(super) task: &'s Task,
    pub(super) pool: &'s Pool,
    pub(super) plan: &'s Plan,
    pub(super) structure: &'s Structure,
    pub(super) built: Built,
    pub(super) findings: &'s [Finding],
}

pub(super) fn found(shown: Shown<'_>) -> PlanFound {
    let Shown { plan, task, built, .. } = shown;
    let reasons = explain(task, plan);
    let steps = plan.steps.iter().zip(reasons).zip(&built.steps);
    let steps = steps.map(|((step, reason), path)| {
        let objects = step.objects.iter().map(|name| task.spelling(name).to_string()).collect();
        let Reason { needs, brings } = reason;
        PlanStep {
            action: step.action.to_string(),
            library: shown
                .pool
                .skill(&step.action)
                .map(|skill| skill.library.to_string())
                .unwrap_or_default(),
            title: built.title(path),
            objects,
            start: step.start,
            duration: step.duration,
            path: path.to_string(),
            needs: needs
                .into_iter()
                .map(|need| PlanNeed { fact: need.fact.to_string(), from: need.from })
                .collect(),
            brings: brings
                .into_iter()
                .map(|gain| PlanGain {
                    fact: gain.fact.to_string(),
                    steps: gain.steps,
                    goal: gain.goal,
                })
                .collect(),
        }
    });
    let steps = steps.collect();
    let selection = edit::Selection {
        container: rafcon_model::StateId::new(""),
        states: vec![Arc::new(built.root)],
        scoped_variables: Vec::new(),
        transitions: Vec::new(),
        data_flows: Vec::new(),
    };
    PlanFound {
        engine: shown.engine.to_owned(),
        after_ms: shown.after_ms,
        cost: plan.cost,
        temporal: plan.temporal,
        makespan: plan.makespan(),
        lost: shown.structure.lost(plan),
        steps,
        machine: Selection::of(&selection),
        findings: findings(shown.findings),
    }
}
