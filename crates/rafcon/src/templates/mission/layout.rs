//! Positions of the parts of a generated machine on the screen.
//!
//! Knows numbers and the file's layout entries (`docs/format.md`, layout). The column of a child is its distance in steps
//! from the first child. A long row of columns is broken into lines, so that a container is about as wide as a screen.

use rafcon_model::Layout;
use rafcon_model::json::Json;

/// Left and top, or width and height.
pub(super) type Pair = (f64, f64);

/// Size of a state without children.
pub(super) const LEAF: Pair = (120.0, 72.0);
/// Free space between columns and between the children of a column, if these are all leaves.
const GAP: Pair = (80.0, 56.0);
/// Free space between the border of a container and its children.
const MARGIN: f64 = 50.0;
/// Free space above the children, for the name.
const HEADING: f64 = 60.0;
/// Maximum number of children in a column; shorter and unlimited columns are also tried.
const HIGH: usize = 3;
/// Maximum number of columns in a line, unless all fit in one.
const LONG: usize = 8;
/// Preferred ratio of width to height of a container.
const SHAPE: f64 = 1.6;

/// The children of a sequence by steps from the first one; `lines` are its transitions, from child to child.
pub(super) fn by_steps(children: usize, lines: &[(usize, usize)]) -> Vec<Vec<usize>> {
    let mut found = vec![false; children];
    let mut columns = Vec::new();
    let mut column: Vec<usize> = (0..children.min(1)).collect();
    while !column.is_empty() {
        column.retain(|&child| !std::mem::replace(&mut found[child], true));
        let next = column
            .iter()
            .flat_map(|&from| lines.iter().filter(move |line| line.0 == from).map(|line| line.1));
        let next = next.collect();
        columns.push(std::mem::replace(&mut column, next));
    }
    columns.push((0..children).filter(|&child| !found[child]).collect());
    columns.retain(|column| !column.is_empty());
    columns
}

/// Positions of children of these sizes, and the size of the container around them. Heights of columns and lengths of lines
/// are chosen for the preferred shape.
pub(super) fn arrange(columns: &[Vec<usize>], sizes: &[Pair]) -> (Vec<Pair>, Pair) {
    let room = roominess(sizes);
    let mut best = in_lines(columns.len().max(1), columns, sizes, room);
    for height in [usize::MAX, HIGH, 1] {
        let columns =
            columns.iter().flat_map(|column| column.chunks(height)).map(<[usize]>::to_vec);
        let columns: Vec<_> = columns.collect();
        for length in 1..=columns.len().min(LONG) {
            let next = in_lines(length, &columns, sizes, room);
            if misshapen(next.1) < misshapen(best.1) {
                best = next;
            }
        }
    }
    best
}

/// Distance of a size from the preferred shape.
fn misshapen(size: Pair) -> f64 {
    (size.0 / size.1 / SHAPE).ln().abs()
}

/// Factor for the space around children of these sizes: larger children have larger names, which need more space.
fn roominess(sizes: &[Pair]) -> f64 {
    let widest = sizes.iter().map(|size| size.0).fold(LEAF.0, f64::max);
    (widest / LEAF.0).powf(0.45)
}

/// Positions with at most `length` columns in a line, and the size of the container.
fn in_lines(length: usize, columns: &[Vec<usize>], sizes: &[Pair], room: f64) -> (Vec<Pair>, Pair) {
    let (gap, margin, heading) = ((GAP.0 * room, GAP.1 * room), MARGIN * room, HEADING * room);
    let mut places = vec![(margin, heading); sizes.len()];
    let (mut right, mut top) = (0.0f64, heading);
    for line in columns.chunks(length) {
        let (mut x, mut bottom) = (margin, top);
        for column in line {
            let mut y = top;
            for &child in column {
                places[child] = (x, y);
                y += sizes[child].1 + gap.1;
            }
            bottom = bottom.max(y);
            x += column.iter().map(|&child| sizes[child].0).fold(0.0, f64::max) + gap.0;
        }
        right = right.max(x);
        top = bottom;
    }
    (places, (right - gap.0 + margin, top - gap.1 + margin))
}

/// The layout of a state: its position in its parent, its size, and the position of its name if it has children.
pub(in crate::templates) fn entry(at: Pair, size: Pair, has_children: bool) -> Layout {
    let mut state = object([("rel_pos", tuple(at)), ("size", tuple(size))]);
    if has_children {
        let name = [("rel_pos", tuple((10.0, 8.0))), ("size", tuple((size.0 - 20.0, 30.0)))];
        if let Json::Object(members) = &mut state {
            members.insert(0, ("name".into(), object(name)));
        }
    }
    Layout::from_json(&object([("gui", object([("editor_gaphas", state)]))]))
}

fn object<const N: usize>(members: [(&str, Json); N]) -> Json {
    Json::Object(members.into_iter().map(|(key, value)| (key.into(), value)).collect())
}

fn tuple(pair: Pair) -> Json {
    object([
        ("__jsonqualname__", Json::Str("__builtin__.tuple".into())),
        ("items", Json::List(vec![Json::Float(pair.0), Json::Float(pair.1)])),
    ])
}

#[cfg(test)]
mod tests {
    use super::{LEAF, arrange, by_steps};

    #[test]
    fn columns_follow_the_steps_and_keep_what_is_out_of_reach() {
        assert_eq!(by_steps(4, &[(0, 1), (0, 2), (1, 0), (2, 1)]), [vec![0], vec![1, 2], vec![3]]);
        assert!(by_steps(0, &[]).is_empty());
    }

    #[test]
    fn children_never_overlap_and_stand_inside() {
        let sizes = vec![LEAF; 20];
        let columns = (0..10).map(|column| vec![2 * column, 2 * column + 1]).collect::<Vec<_>>();
        let (places, size) = arrange(&columns, &sizes);
        assert!((1.0..2.5).contains(&(size.0 / size.1)), "{size:?}");
        for (one, a) in places.iter().enumerate() {
            assert!(a.0 + LEAF.0 <= size.0 && a.1 + LEAF.1 <= size.1);
            let overlaps =
                |b: &(f64, f64)| (a.0 - b.0).abs() < LEAF.0 && (a.1 - b.1).abs() < LEAF.1;
            assert!(!places[one + 1..].iter().any(overlaps));
        }
    }
}
