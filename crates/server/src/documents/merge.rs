//! Merges layouts that several users changed: an undo reverts a step element by element, so that later moves of others stay. Pure.

use rafcon_model::edit::{Edit, Field, Set};
use rafcon_model::{Json, Layout, Machine, StatePath};
use std::collections::{BTreeMap, BTreeSet};

/// Layouts by state, as a step set them.
pub(super) type Layouts = BTreeMap<StatePath, Layout>;

/// The layouts that a step set, as in the machine after it. `back` is the inverse of the step.
pub(super) fn layouts(back: &Edit, machine: &Machine) -> Layouts {
    let Edit::Restore(restore) = back else { return Layouts::new() };
    let set = restore.steps.iter().filter(|step| is_layout(&step.set));
    let layout = |path: &StatePath| Some((path.clone(), machine.state(path)?.layout.clone()));
    set.filter_map(|step| layout(&step.at)).collect()
}

fn is_layout(set: &Set) -> bool {
    matches!(set, Set::Field(Field::Layout(_)))
}

/// Merges the inverse `way` with changes of layouts since the step set `left`. `Err` names a state with a conflict: the element
/// was changed since.
pub(super) fn merged(way: &Edit, left: &Layouts, machine: &Machine) -> Result<Edit, StatePath> {
    let Edit::Restore(restore) = way else { return Ok(way.clone()) };
    let mut merged = restore.clone();
    let mut seen = BTreeSet::new();
    for step in &mut merged.steps {
        let Set::Field(Field::Layout(wanted)) = &mut step.set else { continue };
        let (Some(left), Some(state)) = (left.get(&step.at), machine.state(&step.at)) else {
            continue;
        };
        if state.layout == *left {
            continue;
        }
        let is_first = seen.insert(step.at.clone());
        let three = is_first.then(|| merge(left, wanted, &state.layout)).flatten();
        *wanted = three.ok_or_else(|| step.at.clone())?;
    }
    Ok(Edit::Restore(merged))
}

/// Applies to `now` the change that the inverse makes to `left`. `None` if an affected element has changed since.
fn merge(left: &Layout, wanted: &Layout, now: &Layout) -> Option<Layout> {
    let (left, wanted, mut merged) = (left.json(), wanted.json(), now.json());
    let keys = [&left, &wanted].into_iter().flat_map(|json| json.as_object().unwrap_or_default());
    let keys: BTreeSet<_> = keys.map(|(key, _)| key.clone()).collect();
    for key in keys {
        let (from, to) = (left.get(&key), wanted.get(&key));
        if from == to {
            continue;
        }
        if merged.get(&key) != from {
            return None;
        }
        match to.cloned() {
            Some(value) => merged.set(&key, value),
            None => drop::<Option<Json>>(merged.remove(&key)),
        }
    }
    Some(Layout::from_json(&merged))
}

#[cfg(test)]
mod tests {
    use super::merge;
    use expect_test::{Expect, expect};
    use rafcon_model::{Layout, json};

    fn check(left: &str, wanted: &str, now: &str, expect: &Expect) {
        let layout = |text| Layout::from_json(&json::parse(text).expect("JSON"));
        let merged = merge(&layout(left), &layout(wanted), &layout(now));
        expect.assert_eq(
            &merged.map_or("refused".into(), |layout| layout.text().unwrap_or("none").to_owned()),
        );
    }

    #[test]
    fn what_others_moved_stays() {
        check(r#"{"a":2}"#, r#"{"a":1}"#, r#"{"a":2,"b":5}"#, &expect![[r#"{"a":1,"b":5}"#]]);
        check(r#"{"a":2}"#, "{}", r#"{"a":2,"b":5}"#, &expect![[r#"{"b":5}"#]]);
        check(r#"{"a":2}"#, "{}", r#"{"a":2}"#, &expect!["none"]);
        check("{}", r#"{"a":1}"#, r#"{"b":5}"#, &expect![[r#"{"a":1,"b":5}"#]]);
    }

    #[test]
    fn what_others_moved_elsewhere_is_not_moved_back() {
        check(r#"{"a":2}"#, r#"{"a":1}"#, r#"{"a":3}"#, &expect!["refused"]);
        check("{}", r#"{"a":1}"#, r#"{"a":3}"#, &expect!["refused"]);
    }
}
