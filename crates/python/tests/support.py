"""Starts the built extension as a runner and talks to it as the command line does; builds small machines on disk."""

import json
import os
import pathlib
import socket
import subprocess
import sys
import tempfile
import threading

from event_stream import EventStream

ROOT = pathlib.Path(__file__).resolve().parents[3]
EXTENSION = os.environ.get("RAFCON_EXTENSION") or str(ROOT / "target/debug/librafcon_python.so")
BINARY = os.environ.get("RAFCON_BINARY") or str(ROOT / "target/debug/rafcon")
PROTOCOL = 3
#: A run that takes longer than this is stuck; no test's answer depends on it.
STUCK_S = 60

BOOTSTRAP = """
import importlib.machinery, importlib.util, sys
loader = importlib.machinery.ExtensionFileLoader("rafcon._native", %r)
spec = importlib.util.spec_from_file_location("rafcon._native", loader.path, loader=loader)
native = importlib.util.module_from_spec(spec)
sys.modules["rafcon._native"] = native
loader.exec_module(native)
sys.exit(native.main(%d))
"""


class Runner:
    """One runner process with our end of its socket."""

    def __init__(self, machine, env=None, hello=None, **launch):
        ours, theirs = socket.socketpair()
        self.folder = tempfile.TemporaryDirectory()
        self.process = subprocess.Popen(
            [sys.executable, "-c", BOOTSTRAP % (EXTENSION, theirs.fileno())],
            pass_fds=[theirs.fileno()],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env={**os.environ, "HOME": self.folder.name, "RAFCON_LIBRARY_PATH": "", **(env or {})},
            start_new_session=True,
        )
        theirs.close()
        self._printed = {}
        self._pumps = [self._pump(name) for name in ("stdout", "stderr")]
        self._stuck = False
        self._watchdog = threading.Timer(STUCK_S, self._kill)
        self._watchdog.daemon = True
        self._watchdog.start()
        self.socket = ours
        self._stream = ours.makefile("rb")
        self._events = EventStream(self._stream)
        self.messages = []
        self.send(hello or {"protocol": PROTOCOL, "program": "test"})
        launch = {"every_event": True, "run_folder": self.folder.name, "config": None, **launch}
        self.send({"message": "launch", "machine": str(machine), **launch})
        self.hello = self._hello()

    def _pump(self, name):
        stream = getattr(self.process, name)

        def read():
            with stream:
                self._printed[name] = stream.read().decode("utf-8", "replace")

        thread = threading.Thread(target=read, daemon=True)
        thread.start()
        return thread

    def send(self, message):
        try:
            self.socket.sendall(json.dumps(message).encode() + b"\n")
        except (BrokenPipeError, ConnectionResetError):
            pass

    def command(self, name, id="1", **fields):
        self.send({"message": "command", "id": id, "command": {"type": name}, **fields})

    def _hello(self):
        try:
            line = self._stream.readline()
        except ConnectionResetError:
            line = b""
        return json.loads(line) if line else None

    def _next(self):
        try:
            return self._events.next()
        except ConnectionResetError:
            return None

    def read(self, wanted=lambda message: False):
        """Messages up to and including the first that is wanted; None if the talk ended before that."""
        while True:
            message = self._next()
            if message is None:
                return None
            self.messages.append(message)
            if wanted(message):
                return message

    def read_event(self, wanted):
        """The first event that is wanted."""
        found = self.read(lambda message: message["message"] == "event" and wanted(message["event"]))
        return found and found["event"]

    def entered(self, path):
        """Reads until the state at a path is entered."""
        return self.read_event(lambda event: event["type"] == "entered" and event["path"] == path)

    def said(self, text):
        """Reads until a line is logged that contains a text."""
        return self.read_event(lambda event: event["type"] == "log" and text in event["message"])

    def question(self):
        """Reads until a state asks people, and returns what it asks."""
        asked = self.read_event(lambda event: event["type"] == "asked")
        return asked and asked["question"]

    def answer(self, **value):
        """Reads until a state asks, and answers; returns the question."""
        question = self.question()
        name = "answer %s" % question["id"]
        command = {"type": "answer_question", "question": question["id"], "value": value}
        self.send({"message": "command", "id": name, "command": command})
        return question

    def _kill(self):
        self._stuck = True
        self.process.kill()

    def finish(self):
        """Reads to the end of the talk and of the process."""
        self.read()
        self.process.wait()
        for pump in self._pumps:
            pump.join()
        self._watchdog.cancel()
        self._stream.close()
        self.socket.close()
        files = self._files()
        self.folder.cleanup()
        assert not self._stuck, "the run was stuck for %s s" % STUCK_S
        return Result(self.messages, self.process.returncode, self._printed, files)

    def _files(self):
        names = ("active", "paths")
        folder = pathlib.Path(self.folder.name)
        return {name: (folder / name).read_bytes() for name in names if (folder / name).exists()}


class Result:
    """All that a run said."""

    def __init__(self, messages, exit_code, printed, files):
        self.messages = messages
        self.exit_code = exit_code
        self.printed = printed
        self.files = files
        self.events = [message["event"] for message in messages if message["message"] == "event"]

    @property
    def finished(self):
        return next((event for event in self.events if event["type"] == "finished"), None)

    @property
    def outcome(self):
        return self.finished and self.finished["outcome"]["name"]

    def steps(self):
        """``+path`` for entered, ``-path=outcome`` for left, in order."""
        found = []
        for event in self.events:
            if event["type"] == "entered":
                found.append("+" + event["path"])
            elif event["type"] == "left":
                found.append("-%s=%s" % (event["path"], event["outcome"]["name"]))
        return found

    def logged(self, stream=None, path=None):
        """The lines of a stream and a state, in order."""
        return [
            event["message"]
            for event in self.events
            if event["type"] == "log" and stream in (None, event["stream"]) and path in (None, event["path"])
        ]

    def running_at_the_end(self):
        """The paths of the scripts that ran when the process died."""
        import struct

        lines = self.files["paths"].decode().splitlines()
        count = len(self.files["active"]) // 4
        numbers = struct.unpack("<%dI" % count, self.files["active"])
        return sorted({lines[number - 1] for number in numbers if number})


def run(machine, **launch):
    """Runs a machine to its end."""
    return Runner(machine, **launch).finish()


def script(text, id="A", inputs=(), outputs=(), outcomes=("success",), decider=False):
    """An execution state; ports are (name, type, default)."""
    return {
        "class": "barrier_concurrency_state.DeciderState" if decider else "execution_state.ExecutionState",
        "id": "unique_decider_state_id" if decider else id,
        "inputs": list(inputs),
        "outputs": list(outputs),
        "outcomes": list(outcomes),
        "script": text,
    }


_CONTAINERS = {
    "hierarchy": "hierarchy_state.HierarchyState",
    "barrier": "barrier_concurrency_state.BarrierConcurrencyState",
    "preemptive": "preemptive_concurrency_state.PreemptiveConcurrencyState",
}


def container(kind, children, transitions=(), flows=(), id="R", inputs=(), outputs=(), scoped=(), outcomes=("success",)):
    """A container; transitions are (from, outcome, to) with to an id or an outcome's number, flows (from, port, to, port)
    by names; ``None`` is the container itself."""
    return {
        "class": _CONTAINERS[kind],
        "id": id,
        "inputs": list(inputs),
        "outputs": list(outputs),
        "scoped": list(scoped),
        "outcomes": list(outcomes),
        "children": list(children),
        "transitions": list(transitions),
        "flows": list(flows),
    }


def sequence(*children, **options):
    """A hierarchy whose children run one after the other."""
    ids = [child["id"] for child in children]
    transitions = [(None, None, ids[0])]
    transitions += [(this, 0, after) for this, after in zip(ids, ids[1:] + [0])]
    return container("hierarchy", children, transitions, **options)


def save(folder, root):
    """Writes a machine to a folder in the reference's format; returns the folder."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    header = {"creation_time": "2026-01-01 12:00:00", "state_machine_version": None, "used_rafcon_version": "2.5.2"}
    (folder / "statemachine.json").write_text(json.dumps(header))
    _save_state(folder, root)
    return folder


def _save_state(folder, state):
    core = {
        "__jsonqualname__": "rafcon.core.states." + state["class"],
        "description": None,
        "income": {"__jsonqualname__": "rafcon.core.state_elements.logical_port.Income"},
        "name": state.get("name", state["id"].lower()),
        "state_id": state["id"],
        "outcomes": _outcomes(state["outcomes"]),
        "input_data_ports": _ports(state, "inputs", "data_port.InputDataPort", 0),
        "output_data_ports": _ports(state, "outputs", "data_port.OutputDataPort", 100),
    }
    if "children" in state:
        core["scoped_variables"] = _ports(state, "scoped", "scope.ScopedVariable", 200)
        core["transitions"] = _transitions(state)
        core["data_flows"] = _flows(state)
    if "library" in state:
        core.update(state["library"])
    (folder / "core_data.json").write_text(json.dumps(core))
    if state.get("script") is not None:
        (folder / "script.py").write_text(state["script"])
    if "semantic_data" in state:
        (folder / "semantic_data.json").write_text(json.dumps(state["semantic_data"]))
    for child in state.get("children", ()):
        below = folder / ("%s_%s" % (child.get("name", child["id"].lower()), child["id"]))
        below.mkdir(exist_ok=True)
        _save_state(below, child)


def _element(cls, **fields):
    return {"__jsonqualname__": "rafcon.core.state_elements." + cls, **fields}


def _outcomes(names):
    named = {-2: "preempted", -1: "aborted", **dict(enumerate(names))}
    outcome = "logical_port.Outcome"
    return {str(key): _element(outcome, name=name, outcome_id=key) for key, name in named.items()}


def _ports(state, group, cls, first):
    ports = {}
    for key, (name, type_name, default) in enumerate(state.get(group, ()), first):
        data_type = {"__type__": type_name if "." in type_name else "__builtin__." + type_name}
        ids = {"scoped_variable_id": key} if group == "scoped" else {"data_port_id": key}
        ports[str(key)] = _element(cls, name=name, data_type=data_type, default_value=default, **ids)
    return ports


def _transitions(state):
    lines = {}
    for key, (from_state, outcome, to) in enumerate(state["transitions"]):
        to_state, to_outcome = (state["id"], to) if isinstance(to, int) else (to, None)
        lines[str(key)] = _element(
            "transition.Transition",
            transition_id=key,
            from_state=from_state,
            from_outcome=outcome,
            to_state=to_state,
            to_outcome=to_outcome,
        )
    return lines


def _flows(state):
    lines = {}
    for key, (from_state, from_port, to_state, to_port) in enumerate(state["flows"]):
        lines[str(key)] = _element(
            "data_flow.DataFlow",
            data_flow_id=key,
            from_state=from_state or state["id"],
            from_key=_port_id(state, from_state, from_port, ("outputs",) if from_state else ("inputs", "scoped")),
            to_state=to_state or state["id"],
            to_key=_port_id(state, to_state, to_port, ("inputs",) if to_state else ("outputs", "scoped")),
        )
    return lines


_FIRST_IDS = {"inputs": 0, "outputs": 100, "scoped": 200}


def _port_id(state, child, name, groups):
    owner = next(c for c in state["children"] if c["id"] == child) if child else state
    for group in groups:
        for key, port in enumerate(owner.get(group, ()), _FIRST_IDS[group]):
            if port[0] == name:
                return key
    raise KeyError(name)
