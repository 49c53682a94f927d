//! Default values of ports, converted to handles once.

use super::node::{Fault, Initial, Scoped};
use crate::{Datum, Literals};
use rafcon_model::{Answer, DataType, Port, Ports, RuntimeValues, Value};
use smol_str::{SmolStr, format_smolstr};
use std::sync::Arc;

/// The default values of output ports, and the ports whose default could not be created.
pub(super) struct Outputs<D> {
    pub(super) values: Arc<[D]>,
    pub(super) bad: Box<[(u32, SmolStr)]>,
}

/// The scoped variables of a container with their defaults.
pub(super) struct ScopedVariables<D> {
    pub(super) list: Box<[Scoped<D>]>,
    pub(super) fault: Option<Fault<D>>,
}

/// The name after a `$`, if the text is a reference to a global variable.
fn global_name(value: &Value) -> Option<&str> {
    match value {
        Value::Str(text) => text.strip_prefix('$').filter(|name| !name.is_empty()),
        Value::None
        | Value::Bool(_)
        | Value::Int(_)
        | Value::BigInt(_)
        | Value::Float(_)
        | Value::List(_)
        | Value::Tuple(_)
        | Value::Set(_)
        | Value::Dict(_)
        | Value::Type(_)
        | Value::Encoded(_) => None,
    }
}

/// The default of a port, or the runtime value that a library state uses instead.
fn source<'m>(port: &'m Port, runtime: Option<&'m RuntimeValues>) -> (&'m Value, bool) {
    match runtime.and_then(|values| values.get(&port.id)) {
        Some(runtime) if runtime.used => (&runtime.value, true),
        Some(_) | None => (&port.default, false),
    }
}

pub(super) fn inputs<D: Datum>(
    ports: &Ports,
    runtime: Option<&RuntimeValues>,
    literals: &mut dyn Literals<D>,
) -> Box<[Initial<D>]> {
    let initial = |port: &Port| {
        let (value, is_runtime) = source(port, runtime);
        match global_name(value) {
            Some(name) => Initial::Global(name.into()),
            None => match literal(value, is_runtime, &port.data_type, literals) {
                Ok(value) => Initial::Is(value),
                Err(reason) => Initial::Bad(reason),
            },
        }
    };
    ports.iter().map(initial).collect()
}

fn literal<D: Datum>(
    value: &Value,
    is_runtime: bool,
    data_type: &DataType,
    literals: &mut dyn Literals<D>,
) -> Result<D, SmolStr> {
    if is_runtime {
        literals.runtime_literal(value, data_type)
    } else {
        literals.literal(value, data_type)
    }
}

/// Converts a default without reading global variables: `$name` stays plain text, because only inputs read
/// such a variable.
fn plain<D: Datum>(
    value: &Value,
    is_runtime: bool,
    data_type: &DataType,
    literals: &mut dyn Literals<D>,
) -> Result<D, SmolStr> {
    let data_type = if global_name(value).is_some() { &DataType::Str } else { data_type };
    literal(value, is_runtime, data_type, literals)
}

pub(super) fn outputs<D: Datum>(
    ports: &Ports,
    runtime: Option<&RuntimeValues>,
    literals: &mut dyn Literals<D>,
) -> Outputs<D> {
    let mut bad = Vec::new();
    let mut make = |(number, port): (u32, &Port)| {
        let (value, is_runtime) = source(port, runtime);
        plain(value, is_runtime, &port.data_type, literals).unwrap_or_else(|reason| {
            bad.push((number, reason));
            D::none()
        })
    };
    let values = (0..).zip(ports).map(&mut make).collect();
    Outputs { values, bad: bad.into() }
}

pub(super) fn scoped<D: Datum>(
    ports: &Ports,
    literals: &mut dyn Literals<D>,
) -> ScopedVariables<D> {
    let mut fault = None;
    let mut make = |port: &Port| {
        let initial = scoped_value(port, literals).unwrap_or_else(|reason| {
            if fault.is_none() {
                fault = Some((port.name.clone(), reason));
            }
            D::none()
        });
        Scoped { port: port.clone(), typed: !takes_anything(&port.data_type), initial }
    };
    let list = ports.iter().map(&mut make).collect();
    let fault = fault.map(|(port, reason)| {
        let text = format!("scoped variable '{port}' cannot be made: {reason}");
        Fault { error: literals.error(&text), port: Some(port), reason }
    });
    ScopedVariables { list, fault }
}

fn scoped_value<D: Datum>(port: &Port, literals: &mut dyn Literals<D>) -> Result<D, SmolStr> {
    let value = plain(&port.default, false, &port.data_type, literals)?;
    if value.is_none() || value.fits(&port.data_type) != Answer::No {
        return Ok(value);
    }
    let (found, declared) = (value.type_name(), &port.data_type);
    Err(format_smolstr!("its default is of type {found}, not {declared}; change one of them"))
}

/// True if the type accepts every value, so that no check is needed.
pub(super) fn takes_anything(data_type: &DataType) -> bool {
    matches!(data_type, DataType::Object | DataType::None)
}
