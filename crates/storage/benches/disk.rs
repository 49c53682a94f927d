//! Loading and saving a machine of realistic size, with a warm file cache.

use criterion::{Criterion, criterion_group, criterion_main};
use rafcon_model::{Machine, State};
use rafcon_storage::{Libraries, Loaded, Naming, load, save};
use rafcon_testkit::notation;
use std::sync::Arc;

/// Hierarchies, and states with scripts and ports in each of them.
const HIERARCHIES: usize = 30;
const STATES: usize = 24;

fn machine() -> Machine {
    let parts = (0..HIERARCHIES).map(hierarchy).collect::<Vec<_>>().concat();
    let text = format!("hierarchy ROOT\n  outcome done\n  start -> H0\n{parts}");
    notation::parse(&text).unwrap_or_else(|error| panic!("{error}"))
}

fn hierarchy(number: usize) -> String {
    let next = (number + 1) % HIERARCHIES;
    let states = (0..STATES).map(state).collect::<Vec<_>>().concat();
    format!(
        "  H{number}.done -> H{next}\n  hierarchy H{number} \"Part {number}\"\n    outcome done\n    start -> S0\n{states}"
    )
}

fn state(number: usize) -> String {
    let next = (number + 1) % STATES;
    format!(
        "    S{number}.next -> S{next}\n    S{number}.done -> .done
    execution S{number} \"Step {number}\"
      outcome next
      outcome done
      in before: int = 0
      out after: int = 0
      script |
        def execute(self, inputs, outputs, gvm):
            outputs[\"after\"] = inputs[\"before\"] + 1
            return \"next\"
"
    )
}

fn disk(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().unwrap_or_else(|error| panic!("{error}"));
    let path = folder.path().join("machine");
    let saved = save(&machine(), &path, None, Naming::default());
    saved.unwrap_or_else(|error| panic!("{error}"));
    let read = || load(&path, &Libraries::default()).unwrap_or_else(|error| panic!("{error}"));
    criterion.bench_function("load_751_states", |bencher| bencher.iter_with_large_drop(read));

    let Loaded { mut machine, mut saved, .. } = read();
    let mut edit = 0;
    criterion.bench_function("save_one_edit", |bencher| {
        bencher.iter(|| {
            edit += 1;
            let root: &mut State = Arc::make_mut(&mut machine.root);
            root.description = Some(format!("edit {edit}").into());
            saved = save(&machine, &path, Some(&saved), Naming::default())
                .unwrap_or_else(|error| panic!("{error}"));
        });
    });
}

criterion_group!(benches, disk);
criterion_main!(benches);
