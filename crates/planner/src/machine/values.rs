//! The values for the input ports of a step: the runtime data of its objects, otherwise their names.

use super::Build;
use crate::finding::Finding;
use crate::plan::{Step, spelling};
use crate::skill::{self, Skill};
use rafcon_model::{DataType, Port, RuntimeValue, RuntimeValues, State, Value};
use smol_str::SmolStr;

/// The runtime data of objects, by object name.
pub type Data = [(SmolStr, Value)];

/// The values of a library state for a step. `library` is the skill's own library, or the one that checks it.
pub(super) fn of(
    skill: &Skill,
    library: &SmolStr,
    root: &State,
    step: &Step,
    build: &Build<'_>,
) -> Result<RuntimeValues, Finding> {
    let objects = &build.task.problem.objects;
    let mut values = defaults(root);
    for (parameter, name) in skill.action.parameters.iter().zip(&step.objects) {
        let Some(port) = skill::port(root, &parameter.name) else { continue };
        let known = build
            .data
            .iter()
            .find(|(object, _)| object.eq_ignore_ascii_case(name))
            .map(|(_, value)| value);
        let value = fitting(port, known, &spelling(name, objects)).ok_or_else(|| {
            let text = format!(
                "the input `{}` takes {}, and the runtime data of `{name}` has none: give one",
                port.name, port.data_type
            );
            Finding::error(&[library], text)
        })?;
        values.insert(port.id, RuntimeValue { value, used: true });
    }
    Ok(values)
}

/// The values of a library state that sets no input.
pub(super) fn defaults(root: &State) -> RuntimeValues {
    let unused = |port: &Port| RuntimeValue { value: port.default.clone(), used: false };
    root.inputs.iter().map(|port| (port.id, unused(port))).collect()
}

fn fitting(port: &Port, known: Option<&Value>, name: &str) -> Option<Value> {
    let anything = matches!(port.data_type, DataType::Object | DataType::None | DataType::Named(_));
    let fits = |value: &Value| match DataType::of(value) {
        Some(data_type) => {
            anything
                || data_type == port.data_type
                || (data_type, &port.data_type) == (DataType::Int, &DataType::Float)
        }
        None => anything,
    };
    let named = || (anything || port.data_type == DataType::Str).then(|| Value::str(name));
    known.filter(|value| fits(value)).cloned().or_else(named)
}
