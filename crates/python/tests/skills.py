"""Writes skills as libraries, for tests of plans."""

import json

DONE = 'def execute(self, inputs, outputs, gvm):\n    return "success"\n'


def _port(kind, key, name):
    return {
        "__jsonqualname__": f"rafcon.core.state_elements.data_port.{kind}",
        "data_port_id": key,
        "data_type": {"__type__": "__builtin__.str"},
        "default_value": "",
        "name": name,
    }


def write_skill(pool, name, action="", script=DONE, inputs=(), outputs=()):
    """A library with an action; without one, it is no skill."""
    folder = pool / name
    folder.mkdir(parents=True)
    element = "rafcon.core.state_elements.logical_port"
    outcomes = {
        str(key): {"__jsonqualname__": f"{element}.Outcome", "name": text, "outcome_id": key}
        for key, text in ((-2, "preempted"), (-1, "aborted"), (0, "success"))
    }
    core = {
        "__jsonqualname__": "rafcon.core.states.execution_state.ExecutionState",
        "description": None,
        "income": {"__jsonqualname__": f"{element}.Income"},
        "input_data_ports": {str(key): _port("InputDataPort", key, port) for key, port in enumerate(inputs)},
        "name": name.capitalize(),
        "outcomes": outcomes,
        "output_data_ports": {str(key): _port("OutputDataPort", key, port) for key, port in enumerate(outputs, 100)},
        "state_id": "SKILLX",
    }
    header = {"creation_time": "2026-01-01 00:00:00", "state_machine_version": None, "used_rafcon_version": "2.5.2"}
    notes = {"pddl_action": action, "pddl_predicates": "", "pddl_types": "", "requirements": [], "description": ""}
    files = {"core_data.json": json.dumps(core), "statemachine.json": json.dumps(header), "script.py": script}
    if action:
        files["semantic_data.json"] = json.dumps({"RAFCONTPP": {"PDDL_ACTION": notes}})
    for file, text in files.items():
        (folder / file).write_text(text)
