"""The log of a run as a file for :mod:`rafcon.utils.execution_log`, made of the run's history."""

import datetime
import os
import pickle
import shelve

from rafcon.core.config import global_config


def write(machine):
    """Writes the history of the last run of a machine to a file and returns its name."""
    root = machine.root_state
    folder = _folder()
    os.makedirs(folder, exist_ok=True)
    time = datetime.datetime.now().strftime("%Y-%m-%d_%H-%M-%S.%f")
    file = os.path.join(folder, f"{time}_rafcon_execution_log_{root.name.replace(' ', '-')}.shelve")
    with shelve.open(file, flag="n", protocol=2) as log:
        for entry in _entries(machine):
            log[entry["history_item_id"]] = entry
    return file


def _folder():
    from rafcon.utils.constants import RAFCON_TEMP_PATH_BASE

    path = global_config.get_config_value("EXECUTION_LOG_PATH").replace("%RAFCON_TEMP_PATH_BASE", RAFCON_TEMP_PATH_BASE)
    return os.path.expandvars(os.path.expanduser(path))


def _entries(machine):
    """The items of the history, as dictionaries; a step back is no part of it."""
    before, runs, number = None, {}, 0
    for item in machine.execution_histories[-1]:
        if item.backward:
            continue
        entry = item.to_dict()
        if entry["item_type"] == "CallItem":
            number += 1
            runs[item.path] = f"run_id.{number:020}"
        state = machine.get_state_by_path(item.path, as_check=True)
        pickled = {name: pickle.dumps(value) for name, value in entry["input_output_data"].items()}
        entry.update(history_item_id=f"history_item_id.{item.sequence:020}", prev_history_item_id=before)
        entry.update(run_id=runs.get(item.path, "run_id.before"), input_output_data=pickled, scoped_data={})
        entry.update(_about(state))
        if entry["item_type"] == "CallItem":
            del entry["outcome_name"], entry["outcome_id"]
        before = entry["history_item_id"]
        yield entry


def _about(state):
    """What a log says of a state that may be gone."""
    reference = getattr(state, "library_name", None)
    inner = getattr(state, "state_copy", None)
    return {
        "state_name": getattr(state, "name", None),
        "path_by_name": None if state is None else state.get_path(by_name=True),
        "description": getattr(state, "description", None),
        "semantic_data": {}
        if state is None
        else {key: pickle.dumps(state.semantic_data[key]) for key in state.semantic_data},
        "is_library": reference is not None,
        "library_name": reference,
        "library_path": getattr(state, "library_path", None),
        "library_state_name": None if inner is None else inner.name,
    }
