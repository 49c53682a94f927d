//! The picture of a running machine as lines: active states, their durations and phases. Pure; knows no terminal.

use crate::view::text::{Style, TextLine, counted, harmless, time};
use rafcon_protocol::{ActiveState, Phase, RunStatus, Snapshot};
use std::collections::BTreeMap;
use std::time::Duration;

/// Inputs of the picture.
#[derive(Debug)]
pub(super) struct Picture<'a> {
    pub(super) machine: &'a str,
    /// Last snapshot of the run.
    pub(super) snapshot: &'a Snapshot,
    /// Age of the snapshot.
    pub(super) age: Duration,
    /// True if characters beyond ASCII may be drawn.
    pub(super) unicode: bool,
    /// Names, by path, of the next states of held branches.
    pub(super) names: &'a BTreeMap<String, String>,
    /// Path of the selected state.
    pub(super) selected: Option<&'a str>,
}

/// The picture in at most `height` lines of at most `width` columns.
pub(super) fn draw(picture: &Picture<'_>, width: usize, height: usize) -> Vec<TextLine> {
    let rows = rows(&picture.snapshot.active);
    let room = height.saturating_sub(1);
    let all = rows.len() <= room;
    let shown = if all { rows.len() } else { room.saturating_sub(1) };
    let mut lines = vec![head(picture, width)];
    lines.extend(rows.iter().take(shown).map(|row| state(picture, row, width)));
    if !all && room > 0 {
        let rest = format!("   and {} more", rows.len() - shown);
        lines.push(TextLine::of(Style::Dim, rest).cut(width));
    }
    lines.truncate(height);
    lines
}

fn head(picture: &Picture<'_>, width: usize) -> TextLine {
    let snapshot = picture.snapshot;
    let (style, word) = match snapshot.status {
        RunStatus::Running => (Style::Good, "running"),
        RunStatus::Paused => (Style::Warning, "paused"),
        RunStatus::Stepping => (Style::Warning, "stepping"),
        RunStatus::Stopping => (Style::Warning, "stopping"),
        RunStatus::Finished => (Style::Dim, "finished"),
    };
    let elapsed = Duration::from_millis(snapshot.elapsed_ms) + picture.age;
    let root = snapshot.active.first().filter(|root| !root.path.contains('/'));
    let held = root.filter(|root| root.phase == Phase::Held);
    let held = held.map(|root| format!(", {}", held_text(root, picture.names)));
    let left = TextLine::of(Style::Strong, harmless(picture.machine))
        .and(Style::Plain, "  ")
        .and(style, word)
        .and(Style::Warning, held.unwrap_or_default());
    let states = format!("{} run  ", counted(snapshot.states_run, "state"));
    let time = TextLine::of(Style::Strong, time(elapsed));
    let right = TextLine::of(Style::Dim, states).followed_by(time.clone());
    let fits = left.width() + right.width() < width;
    let rule = if picture.unicode { '─' } else { '-' };
    left.with_right_after(rule, if fits { right } else { time }, width)
}

/// Paths of the active states in the order of the picture.
pub(super) fn order(active: &[ActiveState]) -> Vec<&str> {
    rows(active).into_iter().map(|row| row.state.path.as_str()).collect()
}

/// One line of the tree.
#[derive(Debug)]
struct Row<'a> {
    state: &'a ActiveState,
    /// For each level below the root: true if a sibling follows below.
    followed: Vec<bool>,
}

/// The active states in the order of the tree; a library and its content share a row. The root is the headline.
fn rows(active: &[ActiveState]) -> Vec<Row<'_>> {
    let mut sorted: Vec<&ActiveState> =
        active.iter().filter(|state| state.path.contains('/')).collect();
    sorted.sort_by(|a, b| a.path.split('/').cmp(b.path.split('/')));
    let mut rows: Vec<Row<'_>> = Vec::new();
    let mut levels: Vec<&str> = Vec::new();
    for state in sorted {
        while levels.last().is_some_and(|above| !is_inside(&state.path, above)) {
            levels.pop();
        }
        let alone = rows.last().filter(|row| is_inside(&state.path, &row.state.path));
        if alone.is_some_and(|row| row.state.name == state.name) {
            if let Some(row) = rows.last_mut() {
                row.state = state;
            }
            continue;
        }
        rows.push(Row { state, followed: vec![false; levels.len() + 1] });
        levels.push(&state.path);
    }
    mark_followed(&mut rows);
    rows
}

fn is_inside(path: &str, above: &str) -> bool {
    path.strip_prefix(above).is_some_and(|rest| rest.starts_with('/'))
}

/// Marks, from the last row up, the lines that must continue to a later sibling.
fn mark_followed(rows: &mut [Row<'_>]) {
    let mut below: Vec<bool> = Vec::new();
    for row in rows.iter_mut().rev() {
        let depth = row.followed.len();
        below.resize(depth, false);
        row.followed.copy_from_slice(&below);
        if let Some(last) = below.last_mut() {
            *last = true;
        }
    }
}

fn state(picture: &Picture<'_>, row: &Row<'_>, width: usize) -> TextLine {
    let (style, word) = match row.state.phase {
        Phase::Running => (Style::Plain, String::new()),
        Phase::Waiting => (Style::Warning, "waiting  ".to_owned()),
        Phase::Held => (Style::Warning, format!("{}  ", held_text(row.state, picture.names))),
        Phase::Interrupted => (Style::Bad, "interrupted by a crash  ".to_owned()),
        Phase::Preempted => (Style::Warning, "preempted  ".to_owned()),
    };
    let since = Duration::from_millis(row.state.since_ms) + picture.age;
    let time = TextLine::of(Style::Dim, format!("{:>6}", time(since)));
    let right = TextLine::of(style, word).followed_by(time.clone());
    let selected = picture.selected == Some(row.state.path.as_str());
    let name_style = if selected { Style::Strong } else { style };
    let mark = if selected { "> " } else { "" };
    let left = TextLine::of(Style::Dim, branch(&row.followed, picture.unicode))
        .and(Style::Good, mark)
        .and(name_style, harmless(&row.state.name));
    let fits = left.width() + right.width() < width;
    left.with_right(if fits { right } else { time }, width)
}

/// The state before which a state is held.
fn held_text(state: &ActiveState, names: &BTreeMap<String, String>) -> String {
    let name = |path: &String| {
        let name = names.get(path).map_or(path.as_str(), String::as_str);
        harmless(name.rsplit('/').next().unwrap_or_default())
    };
    let nexts: Vec<String> =
        state.held.iter().filter_map(|hold| hold.next.as_ref()).map(name).collect();
    if nexts.is_empty() {
        "paused".to_owned()
    } else {
        format!("paused before {}", nexts.join(", "))
    }
}

/// The lines that lead to a state.
fn branch(followed: &[bool], unicode: bool) -> String {
    let [go_on, nothing, more, last] =
        if unicode { ["│  ", "   ", "├─ ", "└─ "] } else { ["|  ", "   ", "|- ", "`- "] };
    let Some((own, above)) = followed.split_last() else { return String::new() };
    let above = above.iter().map(|followed| if *followed { go_on } else { nothing });
    above.chain([if *own { more } else { last }]).collect()
}

#[cfg(test)]
mod tests {
    use super::{Picture, draw};
    use crate::view::text::Paint;
    use expect_test::{Expect, expect};
    use rafcon_protocol::{ActiveState, Phase, RunStatus, Snapshot};
    use std::collections::BTreeMap;
    use std::time::Duration;

    const STATES: &str = "
        R|Mission|running|12300
        R/A|Explore|running|8100
        R/A/L|Drive|running|2000
        R/A/L/X|Drive|running|2000
        R/A/L/X/M|Move to waypoint|waiting|1900
        R/A/S|Scan|preempted|100
        R/B|Watch battery|held|12300";

    fn check(width: usize, height: usize, unicode: bool, expect: &Expect) {
        let states = STATES.trim().lines().map(|line| {
            let [path, name, phase, since_ms] =
                line.trim().split('|').collect::<Vec<_>>().try_into().unwrap();
            let phase = match phase {
                "running" => Phase::Running,
                "waiting" => Phase::Waiting,
                "held" => Phase::Held,
                _ => Phase::Preempted,
            };
            let (path, name) = (path.to_owned(), name.to_owned());
            ActiveState {
                path,
                name,
                phase,
                since_ms: since_ms.parse().unwrap(),
                branch: String::new(),
                detail: None,
                held: Vec::new(),
            }
        });
        let snapshot = Snapshot {
            status: RunStatus::Running,
            active: states.collect(),
            states_run: 1234,
            elapsed_ms: 12300,
            sequence: 0,
            disk_safe: 0,
            journal_problem: None,
            breakpoints: Vec::new(),
            questions: Vec::new(),
        };
        let age = Duration::from_millis(100);
        let picture = Picture {
            machine: "Mission",
            snapshot: &snapshot,
            age,
            unicode,
            names: &BTreeMap::new(),
            selected: None,
        };
        let lines = draw(&picture, width, height);
        assert!(lines.len() <= height && lines.iter().all(|line| line.width() <= width));
        let paint = Paint { colour: false, unicode };
        let text = lines.iter().map(|line| line.render(paint) + "\n").collect::<String>();
        expect.assert_eq(&text);
    }

    #[test]
    fn the_tree_of_active_states() {
        check(
            60,
            20,
            true,
            &expect![[r"
                Mission  running ────────────────── 1,234 states run  12.4 s
                ├─ Explore                                             8.2 s
                │  ├─ Drive                                            2.1 s
                │  │  └─ Move to waypoint                    waiting   2.0 s
                │  └─ Scan                                 preempted   0.2 s
                └─ Watch battery                              paused  12.4 s
            "]],
        );
    }

    #[test]
    fn a_small_terminal_shows_what_fits() {
        check(
            26,
            5,
            true,
            &expect![[r"
                Mission  running ── 12.4 s
                ├─ Explore           8.2 s
                │  ├─ Drive          2.1 s
                │  │  └─ Move to w…  2.0 s
                   and 2 more
            "]],
        );
    }

    #[test]
    fn a_terminal_without_unicode() {
        check(
            40,
            20,
            false,
            &expect![[r"
                Mission  running ---------------- 12.4 s
                |- Explore                         8.2 s
                |  |- Drive                        2.1 s
                |  |  `- Move to waypoint          2.0 s
                |  `- Scan             preempted   0.2 s
                `- Watch battery          paused  12.4 s
            "]],
        );
    }

    #[test]
    fn a_terminal_without_room() {
        check(
            3,
            1,
            true,
            &expect![[r"
                12…
            "]],
        );
    }
}
