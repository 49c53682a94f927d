//! Validates plans independently of the engine: classical, numeric and temporal plans, by the rules of PDDL 2.1.
//! Happenings at one moment must not disturb each other. Conditions over all time are checked after each moment between
//! start and end.

use crate::ground::{Binding, CLOSE, Changes, Touched, World, compare, value};
use crate::pddl::Action;
use crate::plan::{Plan, Step};
use crate::task::Task;
use std::fmt;

/// A reason why a plan is invalid.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Invalid {
    /// Index of the step; `None` if the goal is not reached.
    pub step: Option<usize>,
    /// Description for the user.
    pub reason: String,
}

impl fmt::Display for Invalid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.step {
            Some(step) => write!(f, "step {}: {}", step + 1, self.reason),
            None => write!(f, "the goal is not reached: {}", self.reason),
        }
    }
}

impl std::error::Error for Invalid {}

struct Bound<'t> {
    index: usize,
    step: &'t Step,
    action: &'t Action,
    binding: Binding,
}

/// The start (0) or end (1) of a step.
#[derive(Clone, Copy)]
struct Happening {
    step: usize,
    end: usize,
    time: f64,
}

/// Runs the plan in the task's world. Returns the final world, or the reason why the plan is invalid.
pub fn validate(task: &Task, plan: &Plan) -> Result<World, Invalid> {
    let mut bound = Vec::with_capacity(plan.steps.len());
    for (index, step) in plan.steps.iter().enumerate() {
        let at = |reason| Invalid { step: Some(index), reason };
        let (action, binding) = task.bind(step).map_err(at)?;
        if plan.temporal && action.duration.is_some() && step.duration.is_none() {
            return Err(at("it has no duration".to_owned()));
        }
        bound.push(Bound { index, step, action, binding });
    }
    let mut world = task.world();
    let happenings = happenings(&bound);
    let mut running: Vec<usize> = Vec::new();
    for moment in happenings.chunk_by(|a, b| b.time - a.time < CLOSE) {
        run_moment(task, &bound, moment, &mut world)?;
        for happening in moment {
            if happening.end == 1 {
                running.retain(|step| *step != happening.step);
            } else if bound[happening.step].action.duration.is_some() {
                running.push(happening.step);
            }
        }
        for step in &running {
            let Bound { action, binding, .. } = &bound[*step];
            if let Some(reason) = task.ground().unmet(&action.needs[1], binding, &world) {
                return Err(Invalid {
                    step: Some(*step),
                    reason: format!("{reason} while it runs"),
                });
            }
        }
    }
    match task.ground().unmet(&task.problem.goal, &Binding::default(), &world) {
        Some(reason) => Err(Invalid { step: None, reason }),
        None => Ok(world),
    }
}

fn happenings(bound: &[Bound<'_>]) -> Vec<Happening> {
    let mut all = Vec::new();
    for Bound { index, step, action, .. } in bound {
        all.push(Happening { step: *index, end: 0, time: step.start });
        if action.duration.is_some() {
            // An action with duration in a plan without time ends before the next begins.
            let time = if step.duration.is_some() { step.end() } else { step.start + 0.5 };
            all.push(Happening { step: *index, end: 1, time });
        }
    }
    all.sort_by(|a, b| a.time.total_cmp(&b.time));
    all
}

fn run_moment(
    task: &Task,
    bound: &[Bound<'_>],
    moment: &[Happening],
    world: &mut World,
) -> Result<(), Invalid> {
    let ground = task.ground();
    let mut touched: Vec<(usize, Touched)> = Vec::new();
    let mut all = Changes::default();
    for happening in moment {
        let Bound { index, action, binding, .. } = &bound[happening.step];
        let at = |reason| Invalid { step: Some(*index), reason };
        if happening.end == 0 {
            check_duration(&bound[happening.step], world).map_err(at)?;
        }
        let need = &action.needs[happening.end * 2];
        if let Some(reason) = ground.unmet(need, binding, world) {
            return Err(at(reason));
        }
        let effect = &action.effects[happening.end];
        ground.changes(effect, binding, world, &mut all).map_err(at)?;
        if moment.len() > 1 {
            let mut touch = Touched::default();
            ground.touch_condition(need, binding, &mut touch);
            ground.touch_effect(effect, binding, &mut touch);
            if let Some((other, _)) =
                touched.iter().find(|(other, before)| other != index && before.disturbs(&touch))
            {
                return Err(at(format!("it disturbs step {}, which is simultaneous", other + 1)));
            }
            touched.push((*index, touch));
        }
    }
    world.apply(&all);
    Ok(())
}

fn check_duration(bound: &Bound<'_>, world: &World) -> Result<(), String> {
    let (Some(bounds), Some(duration)) = (&bound.action.duration, bound.step.duration) else {
        return Ok(());
    };
    for (how, number) in bounds {
        let limit = value(number, &bound.binding, world)?;
        // Engines write durations with three digits.
        if !compare(*how, duration, limit) && (duration - limit).abs() > 0.002 {
            return Err(format!("it takes {duration}, and ({how} ?duration {limit}) is asked for"));
        }
    }
    Ok(())
}
