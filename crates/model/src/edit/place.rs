//! Positions on the screen: reads and changes the layout of a state (`docs/format.md`, layout).

use super::error::EditError;
use super::plan::state_at;
use super::step::{Field, Set, Step};
use crate::{
    DataFlowId, Json, Layout, Machine, OutcomeId, PortId, PortKind, StatePath, TransitionId,
};
use smol_str::{SmolStr, format_smolstr};

/// An element with its own position in the layout of a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum LayoutElement {
    /// The state itself, in its parent.
    State,
    /// The box with its name, inside the state.
    Name,
    /// The income on its border.
    Income,
    /// An outcome, on its border.
    Outcome(OutcomeId),
    /// A port on its border, or a scoped variable.
    Port(PortKind, PortId),
    /// A transition inside the state.
    Transition(TransitionId),
    /// A data flow inside the state.
    DataFlow(DataFlowId),
}

/// A change of a state's layout. Points are (x, y), y downwards, in the coordinates of the file.
#[derive(Debug, Clone, PartialEq)]
pub enum LayoutEdit {
    /// Sets the position of an element.
    SetPosition(LayoutElement, (f64, f64)),
    /// Sets the width and height of a state or its name.
    SetSize(LayoutElement, (f64, f64)),
    /// Sets the points between the ends of a transition or data flow.
    SetWaypoints(LayoutElement, Vec<(f64, f64)>),
    /// Replaces the whole layout document.
    Set(Layout),
}

const POSITION: &str = "rel_pos";
const SIZE: &str = "size";
const WAYPOINTS: &str = "waypoints";

impl LayoutElement {
    /// Its position in a layout document, if that has one.
    pub fn position(self, layout: &Json) -> Option<(f64, f64)> {
        point(self.find(layout, POSITION)?)
    }

    /// Its size in a layout document, if that has one.
    pub fn size(self, layout: &Json) -> Option<(f64, f64)> {
        point(self.find(layout, SIZE)?)
    }

    /// Its points in a layout document. Empty if the document has none.
    pub fn waypoints(self, layout: &Json) -> Vec<(f64, f64)> {
        let points = self.find(layout, WAYPOINTS).and_then(items);
        points.into_iter().flatten().filter_map(point).collect()
    }

    fn find<'l>(self, layout: &'l Json, what: &str) -> Option<&'l Json> {
        self.keys(what).iter().try_fold(layout, |json, key| json.get(key))
    }

    /// The keys from the outside in.
    fn keys(self, what: &str) -> Vec<SmolStr> {
        let name = (self == Self::Name).then(|| "name".into());
        let keys = self.key().into_iter().chain(["gui".into(), "editor_gaphas".into()]);
        keys.chain(name).chain([what.into()]).collect()
    }

    /// The key of its own at the top of the document.
    pub(super) fn key(self) -> Option<SmolStr> {
        Some(match self {
            Self::State | Self::Name => return None,
            Self::Income => "income".into(),
            Self::Outcome(id) => format_smolstr!("outcome{id}"),
            Self::Port(PortKind::Input, id) => format_smolstr!("input_data_port{id}"),
            Self::Port(PortKind::Output, id) => format_smolstr!("output_data_port{id}"),
            Self::Port(PortKind::ScopedVariable, id) => format_smolstr!("scoped_variable{id}"),
            Self::Transition(id) => format_smolstr!("transition{id}"),
            Self::DataFlow(id) => format_smolstr!("data_flow{id}"),
        })
    }
}

/// Two numbers: a list, or a tuple in the encoding of the file.
fn point(json: &Json) -> Option<(f64, f64)> {
    match items(json)? {
        [x, y] => Some((x.as_number()?, y.as_number()?)),
        _ => None,
    }
}

fn items(json: &Json) -> Option<&[Json]> {
    json.as_list().or_else(|| json.get("items")?.as_list())
}

pub(super) fn plan(
    machine: &Machine,
    path: &StatePath,
    edit: &LayoutEdit,
) -> Result<Vec<Step>, EditError> {
    let earlier = &state_at(machine, path)?.layout;
    let with = |element: &LayoutElement, what: &str, value: Json| {
        let mut document = earlier.json();
        set_at(&mut document, &element.keys(what), value);
        Layout::from_json(&document)
    };
    let layout = match edit {
        LayoutEdit::SetPosition(element, at) => with(element, POSITION, tuple(at.0, at.1)),
        LayoutEdit::SetSize(element, size) => with(element, SIZE, tuple(size.0, size.1)),
        LayoutEdit::SetWaypoints(element, points) => {
            let points = points.iter().map(|point| tuple(point.0, point.1)).collect();
            with(element, WAYPOINTS, Json::List(points))
        }
        LayoutEdit::Set(layout) => layout.clone(),
    };
    Ok(vec![Step::new(path, Set::Field(Field::Layout(layout)))])
}

/// A point in the encoding of the file.
fn tuple(x: f64, y: f64) -> Json {
    Json::Object(vec![
        ("__jsonqualname__".into(), Json::Str("__builtin__.tuple".into())),
        ("items".into(), Json::List(vec![Json::Float(x), Json::Float(y)])),
    ])
}

fn set_at(json: &mut Json, keys: &[SmolStr], value: Json) {
    let [key, rest @ ..] = keys else { return };
    if rest.is_empty() {
        return json.set(key, value);
    }
    let mut inner = json.remove(key).unwrap_or_else(Json::object);
    set_at(&mut inner, rest, value);
    json.set(key, inner);
}
