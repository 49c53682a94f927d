"""Runs one machine in the reference (the PyPI package ``rafcon``) without a desktop and prints what happened.

Uses only the reference's public interface, as any Python program that embeds it would. The answer is one JSON object
on standard output, in the shape that tests/conformance/README.md describes; whatever scripts print is captured into it.
"""

import argparse
import io
import json
import logging
import math
import os
import sys
import tempfile
import time

STOP_GRACE_S = 5.0


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("machine", help="folder of the state machine")
    parser.add_argument("--library-path", action="append", default=[], metavar="NAME=DIR")
    parser.add_argument("--start-from", metavar="PATH", help="state ids joined by /")
    parser.add_argument("--timeout", type=float, default=60.0, metavar="SECONDS", help="stop the run after this time")
    return parser.parse_args()


def encode(value):
    """A Python value as JSON, as docs/protocol.md encodes values; what JSON lacks is marked by a key of its own."""
    if value is None or isinstance(value, (bool, str)):
        return value
    if isinstance(value, int):
        return value if abs(value) < 2**53 else {"__int__": str(value)}
    if isinstance(value, float) and math.isfinite(value):
        return {"__float__": "-0.0"} if value == 0 and math.copysign(1, value) < 0 else value
    if isinstance(value, tuple):
        return {"__tuple__": [encode(item) for item in value]}
    if isinstance(value, list):
        return [encode(item) for item in value]
    if isinstance(value, dict):
        if all(isinstance(key, str) for key in value) and not (value and all(map(str.isdecimal, value))):
            return {key: encode(item) for key, item in value.items()}
        return {"__dict__": [[encode(key), encode(item)] for key, item in value.items()]}
    if isinstance(value, BaseException):
        return {"__exc__": type(value).__name__, "msg": str(value)}
    if isinstance(value, type):
        return {"__type__": value.__name__}
    return {"__repr__": repr(value)[:200], "__class__": type(value).__name__}


class ScriptLog(logging.Handler):
    """Keeps what scripts log, told from the engine's own messages by the file they come from."""

    def __init__(self):
        super().__init__(level=0)
        self.records = []
        self.errors = 0

    def emit(self, record):
        if record.filename.startswith("script.py"):
            state = record.name[7:] if record.name.startswith("rafcon.") else record.name
            self.records.append({"state": state, "level": record.levelname, "message": record.getMessage()})
        elif record.levelno >= logging.ERROR:
            self.errors += 1


def configure(library_paths, folder):
    """Loads a configuration of our own, so that the user's is neither read nor rewritten."""
    from rafcon.core.config import global_config
    from rafcon.core.singleton import library_manager

    roots = "".join(f"    {json.dumps(name)}: {json.dumps(os.path.abspath(path))}\n" for name, path in library_paths)
    with open(os.path.join(folder, "config.yaml"), "w", encoding="utf-8") as file:
        file.write("TYPE: SM_CONFIG\n" + ("LIBRARY_PATHS:\n" + roots if roots else "LIBRARY_PATHS: {}\n"))
    global_config.load(config_file="config.yaml", path=folder)
    library_manager.show_dialog = False
    library_manager.initialize()


def load(machine):
    from rafcon.core.singleton import state_machine_manager
    from rafcon.core.storage import storage

    state_machine = storage.load_state_machine_from_path(machine)
    if state_machine is None:
        raise SystemExit(f"the reference cannot load {machine}")
    state_machine_manager.add_state_machine(state_machine)
    return state_machine


def run(state_machine, start_from, timeout_s):
    """Runs the machine; returns whether it ended by itself."""
    from rafcon.core.singleton import state_machine_execution_engine as engine

    engine.start(state_machine.state_machine_id, start_state_path=start_from)
    if wait_for_end(state_machine, engine, timeout_s):
        return True
    engine.stop()
    wait_for_end(state_machine, engine, STOP_GRACE_S)
    return False


def wait_for_end(state_machine, engine, timeout_s):
    """Joins in small steps: a machine that stops itself may leave the reference's own join waiting forever."""
    deadline = time.monotonic() + timeout_s
    while time.monotonic() < deadline:
        if engine.join(0.05) or not is_active(state_machine.root_state):
            return True
    return False


def is_active(root):
    thread = getattr(root, "thread", None)
    return thread is None or thread.is_alive()


def trace(history, path_of_root):
    """The execution history as ``[path, event]``; concurrent branches follow each other."""
    events = []
    for item in history:
        kind = type(item).__name__
        if kind == "StateMachineStartItem":
            events.append([path_of_root, "start"])
        elif kind == "CallItem":
            events.append([item.path, f"call:{item.call_type.name}"])
        elif kind == "ReturnItem":
            outcome = item.outcome.name if item.outcome else "None"
            events.append([item.path, f"return:{item.call_type.name}>{outcome}"])
        elif kind == "ConcurrencyItem":
            events.append([item.path, "concurrency"])
            for branch in item.execution_histories:
                events.extend(trace(branch, path_of_root))
    return events


def structure(state, found):
    """Paths of the library states and of the concurrency states, which the comparison needs to know."""
    kind = type(state).__name__
    inner = getattr(state, "state_copy", None)
    if inner is not None:
        found["libraries"].append(state.get_path())
        structure(inner, found)
        return found
    if kind in ("BarrierConcurrencyState", "PreemptiveConcurrencyState"):
        found["concurrency"].append(state.get_path())
    for child in getattr(state, "states", {}).values():
        structure(child, found)
    return found


def scoped_variables(root):
    if not hasattr(root, "scoped_variables"):
        return None
    values = {}
    for identifier, variable in root.scoped_variables.items():
        entry = root.scoped_data.get(str(identifier) + root.state_id)
        values[variable.name] = encode(entry.value if entry else variable.default_value)
    return values


def global_variables():
    from rafcon.core.singleton import global_variable_manager as gvm

    return {key: encode(gvm.get_representation(key)) for key in gvm.get_all_keys()}


def main():
    arguments = parse_arguments()
    answer = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    log = ScriptLog()
    with tempfile.TemporaryDirectory() as folder:
        configure([entry.split("=", 1) for entry in arguments.library_path], folder)
        state_machine = load(arguments.machine)
    rafcon_logger = logging.getLogger("rafcon")
    rafcon_logger.addHandler(log)
    sys.stdout = printed = io.StringIO()
    began = time.perf_counter()
    finished = run(state_machine, arguments.start_from, arguments.timeout)
    seconds = time.perf_counter() - began
    sys.stdout = sys.__stdout__
    root = state_machine.root_state
    outcome = root.final_outcome
    found = structure(root, {"libraries": [], "concurrency": []})
    result = {
        "finished": finished,
        "outcome": {"id": outcome.outcome_id, "name": outcome.name} if outcome else None,
        "outputs": encode(root.output_data),
        "globals": global_variables(),
        "scoped_variables": scoped_variables(root),
        "trace": trace(state_machine.execution_histories[-1], root.state_id),
        "log": log.records,
        "errors_logged": log.errors,
        "stdout": printed.getvalue(),
        "seconds": seconds,
        **found,
    }
    json.dump(result, answer, sort_keys=True)
    answer.write("\n")
    answer.flush()
    # Threads of a run that could not be ended must not keep this process alive.
    os._exit(0)


if __name__ == "__main__":
    main()
