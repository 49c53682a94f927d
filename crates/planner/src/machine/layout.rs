//! The layout of a plan's states on the screen, in lines from left to right.

use rafcon_model::{Json, Layout};

/// Width and height, or left and top.
pub(super) type Size = (f64, f64);

/// Size of a state without children.
pub(super) const LEAF: Size = (120.0, 72.0);
const GAP: Size = (80.0, 56.0);
const MARGIN: f64 = 50.0;
const HEADING: f64 = 60.0;
/// Ratio of width to height that a container approximates.
const SHAPE: f64 = 1.6;

/// Positions for children of these sizes, and the size of their container.
pub(super) fn arrange(sizes: &[Size]) -> (Vec<Size>, Size) {
    let area: f64 = sizes.iter().map(|size| (size.0 + GAP.0) * (size.1 + GAP.1)).sum();
    let widest = sizes.iter().map(|size| size.0).fold(0.0, f64::max);
    let right_most = (area * SHAPE).sqrt().max(widest) + MARGIN;
    let mut places = Vec::with_capacity(sizes.len());
    let (mut left, mut top, mut line, mut right) = (MARGIN, HEADING, 0.0f64, LEAF.0);
    for size in sizes {
        if left > MARGIN && left + size.0 > right_most {
            left = MARGIN;
            top += line + GAP.1;
            line = 0.0;
        }
        places.push((left, top));
        left += size.0 + GAP.0;
        line = line.max(size.1);
        right = right.max(left - GAP.0);
    }
    (places, (right + MARGIN, top + line.max(LEAF.1) + MARGIN))
}

/// The layout entry of a state in its file.
pub(super) fn entry(place: Size, size: Size, has_children: bool) -> Layout {
    let mut members = vec![("rel_pos", tuple(place)), ("size", tuple(size))];
    if has_children {
        members.insert(
            0,
            (
                "name",
                object(vec![
                    ("rel_pos", tuple((10.0, 8.0))),
                    ("size", tuple((size.0 - 20.0, 30.0))),
                ]),
            ),
        );
    }
    Layout::from_json(&object(vec![("gui", object(vec![("editor_gaphas", object(members))]))]))
}

fn object(members: Vec<(&str, Json)>) -> Json {
    Json::Object(members.into_iter().map(|(key, value)| (key.into(), value)).collect())
}

fn tuple(pair: Size) -> Json {
    let items = Json::List(vec![Json::Float(pair.0), Json::Float(pair.1)]);
    object(vec![("__jsonqualname__", Json::Str("__builtin__.tuple".into())), ("items", items)])
}
