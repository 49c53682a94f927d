//! Handles a request for a plan: reports findings, or plans as they are found and the end of the search.

use super::engine::{DEFAULT_ENGINE, Engine, PlanRequest};
use super::found::{self, Shown};
use super::pool;
use super::search::{Cancel, SearchEnd, Verdict, millis_since, search};
use crate::{Interpreter, ProgramEnvironment, clock};
use rafcon_model::{Machine, Value, json};
use rafcon_planner::pddl::{Renamed, read_condition, read_problem};
use rafcon_planner::{
    Build, Finding, Order, Plan, Pool, REPLAN, Recovery, Replanning, Severity, Structure, Task,
    Then, build, validate,
};
use rafcon_protocol::api::{
    MakePlan, PlanDomain, PlanEnd, PlanEvent, PlanFound, PlanPool, PlanRefused, PlanThen,
};
use rafcon_protocol::document::{Document, HeaderDocument};
use rafcon_storage::Libraries;
use smol_str::SmolStr;
use std::time::{Duration, Instant};

/// Default time limit of an engine.
const TIME_LIMIT: Duration = Duration::from_secs(10);
const REPLANS_MAX: u32 = 5;
/// Maximum number of steps in a plan with parallel steps: the order of each pair is computed, which takes too long for more.
const ORDERED_MAX: usize = 3000;

/// Libraries, interpreter and environment for requests of plans.
#[derive(Debug, Clone, Copy)]
pub struct Planner<'p> {
    /// Libraries that contain the skills.
    pub libraries: &'p Libraries,
    /// Python interpreter that also executes runs.
    pub python: &'p Interpreter,
    /// Environment in which the engine is searched.
    pub environment: &'p ProgramEnvironment,
}

/// The domain of a pool's skills, with findings.
pub fn domain(pool: &PlanPool, libraries: &Libraries) -> PlanDomain {
    found::domain(&pool::read(pool, libraries))
}

/// Parses the problem and its goal. `Err` describes the fault.
fn problem_of(request: &MakePlan) -> Result<rafcon_planner::pddl::Problem, String> {
    let mut problem = read_problem(&request.facts).map_err(|error| format!("facts: {error}"))?;
    if let Some(goal) = &request.goal {
        problem.goal = read_condition(goal).map_err(|error| format!("goal: {error}"))?;
    }
    if problem.goal.is_nothing() {
        return Err(
            "there is no goal: add `(:goal …)` to the facts, or give one beside them".to_owned()
        );
    }
    Ok(problem)
}

/// A request after parsing and checks.
struct Wanted {
    pool: Pool,
    task: Task,
    findings: Vec<Finding>,
    name: String,
    data: Vec<(SmolStr, Value)>,
    replanning: Option<Replanning>,
}

/// A request that an engine can plan.
struct PlanningJob<'j> {
    /// The request as the client sent it.
    request: &'j MakePlan,
    /// The task that was read from the request.
    wanted: &'j Wanted,
    /// Start of the planning, for the age of plans.
    begin: Instant,
}

impl Planner<'_> {
    /// Plans. Reports each event as it happens, and returns the last one.
    pub fn plan(
        &self,
        request: &MakePlan,
        cancel: &Cancel,
        tell: &mut dyn FnMut(PlanEvent),
    ) -> PlanEvent {
        let begin = clock::now();
        let wanted = match self.wanted(request) {
            Ok(wanted) => wanted,
            Err(findings) => {
                return PlanEvent::Refused(PlanRefused { findings: found::findings(&findings) });
            }
        };
        let end = |reason: String| PlanEnd {
            reason,
            after_ms: millis_since(begin),
            findings: found::findings(&wanted.findings),
        };
        let job = PlanningJob { request, wanted: &wanted, begin };
        match self.search(&job, cancel, tell) {
            Err(reason) | Ok((SearchEnd::Failed(reason), _)) => PlanEvent::Failed(end(reason)),
            Ok((SearchEnd::Enough, found)) => PlanEvent::Done(end(if found > 1 {
                format!("the last of {found} plans is the best")
            } else {
                "a plan was found".to_owned()
            })),
            Ok((SearchEnd::Impossible(reason), _)) => PlanEvent::Impossible(end(reason)),
            Ok((SearchEnd::NotFound(reason), _)) => PlanEvent::NotFound(end(reason)),
            Ok((SearchEnd::Cancelled, _)) => {
                PlanEvent::Cancelled(end("nobody waits for it any more".to_owned()))
            }
        }
    }

    fn wanted(&self, request: &MakePlan) -> Result<Wanted, Vec<Finding>> {
        let pool = pool::read(&request.pool, self.libraries);
        let mut findings = pool.findings.clone();
        let wrong =
            |text: String| Finding { severity: Severity::Error, libraries: Vec::new(), text };
        if pool.skills.is_empty() {
            return Err(findings);
        }
        let problem = match problem_of(request) {
            Ok(problem) => problem,
            Err(text) => {
                findings.push(wrong(text));
                return Err(findings);
            }
        };
        let name = request.name.clone().unwrap_or_else(|| problem.name.to_string());
        let name = Some(name.replace('/', "-").trim().to_owned()).filter(|name| !name.is_empty());
        let (task, more) = Task::new(pool.domain.clone(), problem);
        findings.extend(more);
        let replanning = self.replanning(request).unwrap_or_else(|text| {
            findings.push(wrong(text));
            None
        });
        if findings.iter().any(Finding::is_error) {
            return Err(findings);
        }
        let data = request.data.iter().map(|(object, value)| (object.into(), value_of(value)));
        Ok(Wanted {
            data: data.collect(),
            name: name.unwrap_or_else(|| "plan".to_owned()),
            pool,
            task,
            findings,
            replanning,
        })
    }

    fn replanning(&self, request: &MakePlan) -> Result<Option<Replanning>, String> {
        let Some(observe) = &request.observe else { return Ok(None) };
        let library = |path: &str| {
            let root = pool::library(path, self.libraries)
                .map_err(|reason| format!("the library {path} is missing: {reason}"));
            root.map(|root| (SmolStr::new(path), root))
        };
        let observed = library(observe)?;
        let replan = library(REPLAN).map_err(|missing| {
            format!(
                "{missing}; it comes with RAFCON: `--library-path planning=…/libraries/planning`"
            )
        })?;
        let text = |text: String| Value::str(&text);
        let goal = problem_of(request)?.goal.to_string();
        let object = |entries: Vec<(String, Value)>| {
            Value::Dict(entries.into_iter().map(|(key, value)| (Value::str(&key), value)).collect())
        };
        let types =
            request.pool.types.iter().map(|(child, parent)| (child.clone(), Value::str(parent)));
        let data = request.data.iter().map(|(name, value)| (name.clone(), value_of(value)));
        let recovery = [
            ("retries".to_owned(), Value::Int(request.recovery.retries.into())),
            (
                "then".to_owned(),
                Value::str(match request.recovery.then {
                    PlanThen::GiveUp => "give_up",
                    PlanThen::Ask => "ask",
                    PlanThen::Replan => "replan",
                }),
            ),
        ];
        let seconds = request.time_limit_ms.map_or(TIME_LIMIT, Duration::from_millis).as_secs_f64();
        Ok(Some(Replanning {
            observe: observed,
            replan,
            inputs: vec![
                (
                    "pool".into(),
                    Value::List(
                        request.pool.libraries.iter().map(|path| Value::str(path)).collect(),
                    ),
                ),
                ("observe".into(), Value::str(observe)),
                ("types".into(), object(types.collect())),
                ("goal".into(), text(goal)),
                ("data".into(), object(data.collect())),
                ("engine".into(), Value::str(request.engine.as_deref().unwrap_or(DEFAULT_ENGINE))),
                ("time_limit_s".into(), Value::Float(seconds)),
                (
                    "replans_max".into(),
                    Value::Int(request.replans_max.unwrap_or(REPLANS_MAX).into()),
                ),
                ("recovery".into(), object(recovery.into())),
                ("parallel".into(), Value::Bool(request.parallel)),
            ],
        }))
    }

    /// Runs the engine. Returns its end and the number of plans. `Err` if the engine was not started.
    fn search(
        &self,
        job: &PlanningJob<'_>,
        cancel: &Cancel,
        tell: &mut dyn FnMut(PlanEvent),
    ) -> Result<(SearchEnd, usize), String> {
        let PlanningJob { request, wanted, .. } = *job;
        let name = request.engine.as_deref().unwrap_or(DEFAULT_ENGINE);
        let engine = Engine::find(name, self.python, self.environment);
        let folder = tempfile::tempdir()
            .map_err(|error| format!("cannot make a folder for the engine: {error}"))?;
        let (domain, problem) =
            (folder.path().join("domain.pddl"), folder.path().join("problem.pddl"));
        let write = |file, text: String| {
            std::fs::write(file, text)
                .map_err(|error| format!("cannot write for the engine: {error}"))
        };
        let names = Renamed::new(&wanted.task.domain, &wanted.task.problem);
        write(&domain, names.domain.to_string())?;
        write(&problem, names.problem.to_string())?;
        let actions = &wanted.task.domain.actions;
        let wish = PlanRequest {
            domain: &domain,
            problem: &problem,
            limit: request.time_limit_ms.map_or(TIME_LIMIT, Duration::from_millis),
            anytime: request.anytime,
            classical: wanted.task.domain.functions.is_empty()
                && actions.iter().all(|action| action.duration.is_none()),
        };
        let (mut found, mut best) = (0, None);
        let end = search(&engine, &wish, cancel, &mut |line| {
            let plan = Plan::read(line).map(|mut plan| {
                plan.restore_names(&names);
                plan
            });
            let shown =
                match plan.map_err(Verdict::Wrong).and_then(|plan| self.shown(job, &plan, name)) {
                    Ok(shown) => shown,
                    Err(verdict) => return verdict,
                };
            let price = if shown.temporal { Some(shown.makespan) } else { shown.cost };
            if best.zip(price).is_none_or(|(best, price)| price < best) {
                best = price.or(best);
                found += 1;
                tell(PlanEvent::Found(Box::new(shown)));
            }
            if request.anytime { Verdict::More } else { Verdict::Enough }
        });
        let end = match end {
            SearchEnd::Failed(reason) => SearchEnd::Failed(names.with_originals(&reason)),
            other => other,
        };
        Ok((end, found))
    }

    /// A validated plan with its machine. `Err` gives the reason for its rejection.
    fn shown(
        &self,
        job: &PlanningJob<'_>,
        plan: &Plan,
        engine: &str,
    ) -> Result<PlanFound, Verdict> {
        let PlanningJob { request, wanted, begin } = *job;
        let Wanted { pool, task, .. } = wanted;
        validate(task, plan).map_err(|invalid| Verdict::Wrong(invalid.to_string()))?;
        let is_ordered = plan.temporal || request.parallel;
        if is_ordered && plan.steps.len() > ORDERED_MAX {
            let count = plan.steps.len();
            return Err(Verdict::Unfit(format!(
                "the plan has {count} steps, too many to find out what of them can be done at the same time (at most {ORDERED_MAX}): plan without `--parallel` and durations, or for a smaller goal"
            )));
        }
        let structure = if is_ordered {
            Structure::of(&Order::of(task, plan))
        } else {
            Structure::chain(plan.steps.len())
        };
        structure.check(task, plan).map_err(|invalid| {
            Verdict::Unfit(format!("{invalid} unless steps overlap in time as planned, which no machine can promise: change the skills so that they need not"))
        })?;
        let library = |path: &str| pool::library(path, self.libraries);
        let built = build(&Build {
            name: &wanted.name,
            task,
            pool,
            plan,
            structure: &structure,
            data: &wanted.data,
            recovery: recovery(request),
            replanning: wanted.replanning.as_ref(),
            library: &library,
        });
        let built = built.map_err(|error| Verdict::Unfit(error.to_string()))?;
        let shown = Shown {
            engine,
            after_ms: millis_since(begin),
            task,
            pool,
            plan,
            structure: &structure,
            built,
            findings: &wanted.findings,
        };
        Ok(found::found(shown))
    }
}

fn recovery(request: &MakePlan) -> Recovery {
    let then = match request.recovery.then {
        PlanThen::GiveUp => Then::GiveUp,
        PlanThen::Ask => Then::Ask,
        PlanThen::Replan => Then::Replan,
    };
    Recovery { retries: request.recovery.retries, then }
}

fn value_of(value: &serde_json::Value) -> Value {
    json::parse(&value.to_string()).map_or(Value::None, |json| Value::from_json(&json))
}

/// The machine of a plan, ready to be saved.
pub fn machine_of(found: &PlanFound, libraries: &Libraries) -> Result<Machine, String> {
    let mut library = |state: &mut rafcon_model::State| {
        let _differences = rafcon_storage::fill_library(state, libraries);
    };
    let document =
        Document { header: HeaderDocument::default(), states: found.machine.states.clone() };
    document.read(&mut library).map_err(|error| error.to_string())
}
