//! Machines in, files out.

use super::save;
use crate::Naming;
use crate::testing::{EVERY_KIND, fingerprint, loaded, machine, show_files, show_problems};
use expect_test::expect;
use rafcon_model::notation;

#[test]
fn every_kind_of_state_is_read_as_it_was_written() {
    let dir = tempfile::tempdir().unwrap();
    let written = machine(EVERY_KIND);
    save(&written, dir.path(), None, Naming::default()).unwrap();
    let read = loaded(dir.path());
    assert_eq!(notation::print(&read.machine), notation::print(&written));
    assert_eq!(read.machine, written);
    assert_eq!(show_problems(&read), "");
    expect![[r#"
        all_at_once_BARRIE/Decider_unique_decider_state_id/core_data.json
        all_at_once_BARRIE/Decider_unique_decider_state_id/script.py
        all_at_once_BARRIE/core_data.json
        all_at_once_BARRIE/first_AAAAAA/core_data.json
        all_at_once_BARRIE/first_AAAAAA/script.py
        core_data.json
        last__LASTXX/core_data.json
        {
            "__jsonqualname__": "rafcon.core.states.execution_state.ExecutionState", 
            "description": null, 
            "income": {
                "__jsonqualname__": "rafcon.core.state_elements.logical_port.Income"
            }, 
            "input_data_ports": {
                "0": {
                    "__jsonqualname__": "rafcon.core.state_elements.data_port.InputDataPort", 
                    "data_port_id": 0, 
                    "data_type": {
                        "__type__": "__builtin__.str"
                    }, 
                    "default_value": null, 
                    "name": "cup"
                }
            }, 
            "name": "last \u00e9", 
            "outcomes": {
                "-2": {
                    "__jsonqualname__": "rafcon.core.state_elements.logical_port.Outcome", 
                    "name": "preempted", 
                    "outcome_id": -2
                }, 
                "-1": {
                    "__jsonqualname__": "rafcon.core.state_elements.logical_port.Outcome", 
                    "name": "aborted", 
                    "outcome_id": -1
                }
            }, 
            "output_data_ports": {}, 
            "state_id": "LASTXX"
        }
        last__LASTXX/meta_data.json
        last__LASTXX/script.py
        meta_data.json
        statemachine.json
        {
            "creation_time": "2020-02-02 02:02:02", 
            "state_machine_version": "1.2", 
            "used_rafcon_version": "2.2.0"
        }
        who_is_first_FIRSTX/core_data.json
        who_is_first_FIRSTX/semantic_data.json
        who_is_first_FIRSTX/slow_CCCCCC/core_data.json
        who_is_first_FIRSTX/slow_CCCCCC/script.py
    "#]]
    .assert_eq(&show_files(dir.path(), &["statemachine.json", "LASTXX/core_data.json"]));
    let before = fingerprint(dir.path());
    save(&read.machine, dir.path(), Some(&read.saved), Naming::default()).unwrap();
    assert_eq!(fingerprint(dir.path()), before);
}
