//! Cost of a journal: appending an executed state to the recorder, including the commits, and storing a machine.

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use rafcon_model::{Machine, State};
use rafcon_storage::journal::{About, Batch, Journal, Kept, Left, Options, PlaceNumber};
use rafcon_storage::{Libraries, Packer};
use rafcon_testkit::notation;
use std::fmt::Write as _;
use std::sync::Arc;

/// A flat machine of this many states.
fn machine(states: usize) -> Machine {
    let mut text = "hierarchy ROOT\n  outcome done\n  start -> S0\n".to_owned();
    for number in 0..states {
        let state = format!(
            "  S{number}.next -> S{}\n  execution S{number} \"Step {number}\"\n    outcome next\n    in before: int = 0
    script |\n      def execute(self, inputs, outputs, gvm):\n          return \"next {number}\"\n",
            (number + 1) % states
        );
        write!(text, "{state}").unwrap_or_else(|error| panic!("{error}"));
    }
    notation::parse(&text).unwrap_or_else(|error| panic!("{error}"))
}

fn journal(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().unwrap_or_else(|error| panic!("{error}"));
    let begun = Journal::create(folder.path(), &About::default(), &Options::default());
    let journal = begun.unwrap_or_else(|error| panic!("{error}"));
    let mut batch = Batch::new(0);
    let mut t_ns = 0_u64;
    criterion.bench_function("journal_one_state", |bencher| {
        bencher.iter(|| {
            t_ns += 1000;
            let (place, inputs) = (PlaceNumber(7), [Kept::Int(t_ns.cast_signed())]);
            batch.entered(t_ns, place, &inputs, None);
            let outputs = &inputs;
            batch.left(t_ns, Left { place, outcome: 0, outputs, error: None, undoes: None });
            while journal.append(&batch).is_err() {
                journal.commit().unwrap_or_else(|error| panic!("{error}"));
            }
            batch.clear();
        });
    });

    let mut machine = machine(10_000);
    let libraries = Libraries::default();
    let mut group = criterion.benchmark_group("pack");
    group.sample_size(10);
    group.bench_function("pack_10000_states", |bencher| {
        let packed = |mut packer: Packer| packer.pack(&machine, None, &libraries);
        bencher.iter_batched(Packer::default, packed, BatchSize::PerIteration);
    });
    let mut packer = Packer::default();
    let kept = journal.keep_root(&packer.pack(&machine, None, &libraries));
    kept.unwrap_or_else(|error| panic!("{error}"));
    group.bench_function("keep_one_edit_of_10000_states", |bencher| {
        let mut edit = 0;
        bencher.iter(|| {
            edit += 1;
            let root: &mut State = Arc::make_mut(&mut machine.root);
            root.description = Some(format!("edit {edit}").into());
            let pack = packer.pack(&machine, None, &libraries);
            journal.keep_root(&pack).unwrap_or_else(|error| panic!("{error}"))
        });
    });
}

criterion_group!(benches, journal);
criterion_main!(benches);
