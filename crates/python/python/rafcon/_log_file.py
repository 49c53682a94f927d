"""Log of a run as a file for :mod:`rafcon.utils.execution_log`, made from the run's history."""

import datetime
import os
import pickle
import shelve
import time

from rafcon.core.config import global_config
from rafcon.core.states.concurrency_state import ConcurrencyState


def write(machine):
    """Write the history of the last run of a machine to a file; return the file's name."""
    root = machine.root_state
    folder = _folder()
    os.makedirs(folder, exist_ok=True)
    moment = datetime.datetime.now().strftime("%Y-%m-%d_%H-%M-%S.%f")
    file = os.path.join(folder, f"{moment}_rafcon_execution_log_{root.name.replace(' ', '-')}.shelve")
    with shelve.open(file, flag="n", protocol=2) as log:
        for entry in _entries(machine):
            log[entry["history_item_id"]] = entry
    return file


def _folder():
    from rafcon.utils.constants import RAFCON_TEMP_PATH_BASE

    path = global_config.get_config_value("EXECUTION_LOG_PATH").replace("%RAFCON_TEMP_PATH_BASE", RAFCON_TEMP_PATH_BASE)
    return os.path.expandvars(os.path.expanduser(path))


def _entries(machine):
    """Items of the history as dictionaries, without steps back."""
    entries, items = _Entries(machine), list(machine.execution_histories[-1])
    yield entries.start(items[0].timestamp if items else time.time())
    for item in items:
        if not item.backward:
            yield from entries.of(item)


class _Entries:
    """Converts history items to log entries, each with the id of its predecessor in its branch."""

    def __init__(self, machine):
        self._machine = machine
        self._number = self._run = 0
        self._runs = {}
        # Path of a branch (a state in a concurrency state, or the machine itself) to its last entry.
        self._last = {}

    def start(self, timestamp):
        """Entry for the start of the machine."""
        about = {"path": "", "path_by_name": "", "state_type": "StateMachine", "call_type": "EXECUTE"}
        entry = {
            **_about(None),
            **about,
            "state_name": "StateMachineStartItem",
            "timestamp": timestamp,
            "creation_time": self._machine.creation_time,
            "state_machine_version": self._machine.version,
            "os_environment": {},
        }
        return self._numbered(entry, "StateMachineStartItem", self._next_run(), "")

    def of(self, item):
        """Entry of an item; a call of a concurrency state also has one for its branches."""
        state = self._machine.get_state_by_path(item.path, as_check=True)
        entry = item.to_dict()
        if entry["item_type"] == "CallItem":
            del entry["outcome_name"], entry["outcome_id"]
            if entry["call_type"] == "EXECUTE" or item.path not in self._runs:
                self._runs[item.path] = self._next_run()
        pickled = {name: pickle.dumps(value) for name, value in entry["input_output_data"].items()}
        entry.update(_about(state), input_output_data=pickled, scoped_data={})
        run, branch = self._runs.get(item.path, ""), self._branch(item.path)
        yield self._numbered(entry, entry["item_type"], run, branch)
        if entry["item_type"] == "ReturnItem":
            if entry["call_type"] == "EXECUTE":
                self._runs.pop(item.path, None)
        elif entry["call_type"] == "CONTAINER" and isinstance(state, ConcurrencyState):
            branches = {name: entry[name] for name in entry if name not in ("input_output_data", "scoped_data")}
            yield self._numbered(branches, "ConcurrencyItem", run, branch)
            self._last.update({f"{item.path}/{key}": branches["history_item_id"] for key in state.states})

    def _branch(self, path):
        """Path of the innermost branch that contains a state."""
        above = path
        while above and above not in self._last:
            above = above.rpartition("/")[0]
        return above

    def _next_run(self):
        self._run += 1
        return f"run_id.{self._run:020}"

    def _numbered(self, entry, item_type, run, branch):
        self._number += 1
        key = f"history_item_id.{self._number:020}"
        entry.update(item_type=item_type, run_id=run, history_item_id=key)
        entry["prev_history_item_id"] = self._last.get(branch)
        self._last[branch] = key
        return entry


def _about(state):
    """Description of a state in the log; the state is None if it was removed."""
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
