//! Machines for several tests: one from the notation, and files of an old version.

use crate::notation;
use rafcon_model::Machine;

/// Parses the machine of the notation.
pub fn machine(text: &str) -> Machine {
    match notation::parse(text) {
        Ok(machine) => machine,
        Err(error) => panic!("{error}\n{text}"),
    }
}

/// A machine with every kind of state, without libraries.
pub const EVERY_KIND: &str = r#"
machine
  version "1.2"
  created "2020-02-02 02:02:02"
  writer "2.2.0"
hierarchy ROOTID "The root"
  outcome success
  in cup: str = "red"
  out place: object
  var tries: int = 3
  start -> BARRIE
  BARRIE.success -> FIRSTX
  FIRSTX.done -> .success
  flow .cup -> LASTXX.cup
  layout {"gui":{"x":1}}
  barrier BARRIE "all at once"
    outcome success
    AAAAAA.success -> unique_decider_state_id
    unique_decider_state_id.success -> .success
    execution AAAAAA "first"
      outcome success
      script "a = 1\n"
    decider unique_decider_state_id "Decider"
      outcome success
      script "d = 1\n"
  preemptive FIRSTX "who is first"
    outcome done
    semantic {"a":{"b":"c"}}
    execution CCCCCC "slow"
      script "c = 1\n"
  execution LASTXX "last é"
    in cup: str
    layout {"gui":{"editor_gaphas":{"rel_pos":{"__jsonqualname__":"__builtin__.tuple","items":[1.5,2]}}}}
    script "l = 1\n"
"#;

/// A machine as 0.7.13 wrote it: the root in a folder of its own, `name$ID`, other class names.
pub const VERSION_0_7_13: &str = r#"
== statemachine.json
{"root_state_storage_id": "the root$ROOTID", "state_machine_version": "1.0", "creation_time": "2017-01-01 01:01:01",
 "last_update": "2017-01-02 01:01:01", "used_rafcon_version": "0.7.13"}
== meta_data.json
{}
== the root$ROOTID/core_data.json
{"__jsonqualname__": "rafcon.statemachine.states.hierarchy_state.HierarchyState",
 "name": "the root", "state_id": "ROOTID", "description": null,
 "outcomes": {"-1": {"__jsonqualname__": "rafcon.statemachine.outcome.Outcome", "name": "aborted", "outcome_id": -1}, "-2": {"__jsonqualname__": "rafcon.statemachine.outcome.Outcome", "name": "preempted", "outcome_id": -2}, "0": {"__jsonqualname__": "rafcon.statemachine.outcome.Outcome", "name": "success", "outcome_id": 0}},
 "input_data_ports": {"3": {"__jsonqualname__": "rafcon.statemachine.data_port.DataPort", "data_port_id": 3, "name": "x",
   "data_type": {"__type__": "float"}, "default_value": 1.5}},
 "output_data_ports": {},
 "scoped_variables": {"4": {"__jsonqualname__": "rafcon.statemachine.scope.ScopedVariable", "scoped_variable_id": 4, "name": "v",
   "data_type": {"__type__": "__builtin__.int"}, "default_value": 1}},
 "data_flows": {"1": {"__jsonqualname__": "rafcon.statemachine.data_flow.DataFlow", "data_flow_id": 1, "from_state": "ROOTID",
   "from_key": 3, "to_state": "CHILDX", "to_key": 0}},
 "transitions": {"1": {"__jsonqualname__": "rafcon.statemachine.transition.Transition", "transition_id": 1, "from_state": null, "from_outcome": null, "to_state": "CHILDX", "to_outcome": null},
  "2": {"__jsonqualname__": "rafcon.statemachine.transition.Transition", "transition_id": 2, "from_state": "CHILDX", "from_outcome": 0, "to_state": "ROOTID", "to_outcome": 0}}}
== the root$ROOTID/meta_data.json
{"gui": {"editor_opengl": {}}}
== the root$ROOTID/a child$CHILDX/core_data.json
{"__jsonqualname__": "rafcon.statemachine.states.execution_state.ExecutionState", "name": "a child", "state_id": "CHILDX",
 "description": "does", "outcomes": {"-1": {"__jsonqualname__": "rafcon.statemachine.outcome.Outcome", "name": "aborted", "outcome_id": -1}, "-2": {"__jsonqualname__": "rafcon.statemachine.outcome.Outcome", "name": "preempted", "outcome_id": -2}, "0": {"__jsonqualname__": "rafcon.statemachine.outcome.Outcome", "name": "success", "outcome_id": 0}},
 "input_data_ports": {"0": {"__jsonqualname__": "rafcon.statemachine.data_port.InputDataPort", "data_port_id": 0, "name": "x",
   "data_type": {"__type__": "__builtin__.float"}, "default_value": null}},
 "output_data_ports": {}}
== the root$ROOTID/a child$CHILDX/script.py
def execute(self, inputs, outputs, gvm):
    return 0
"#;
