"""Writes small state machines in the reference's format, from a notation in which connections are short texts.

A transition reads ``"A.success -> B"`` or ``"B.done -> .success"`` (an outcome of the container itself); ``"-> A"`` is
the start. A data flow reads ``"A.out -> B.in"``; ``".x"`` is a port of the container, ``"$x"`` a scoped variable.
Ports are ``{name: (type, default)}``.
"""

import json
import os

CORE = "rafcon.core."
ELEMENTS = CORE + "state_elements."
DECIDER = "unique_decider_state_id"
MANDATORY = {"aborted": -1, "preempted": -2}
CREATED = "2026-01-01 12:00:00"


def _typed(qualified_name, **entries):
    return {"__jsonqualname__": qualified_name, **entries}


def _encoded(value):
    if isinstance(value, type):
        return {"__type__": "__builtin__." + value.__name__}
    if isinstance(value, tuple):
        return _typed("__builtin__.tuple", items=[_encoded(item) for item in value])
    return value


class State:
    """One state: its own file's content, its script and its children."""

    def __init__(self, kind, state_id, name=None, outcomes=("success",), inputs=None, outputs=None):
        self.kind = kind
        self.state_id = state_id
        self.name = name or state_id.lower()
        self.outcomes = {**MANDATORY, **{outcome: number for number, outcome in enumerate(outcomes)}}
        self.inputs = self._numbered(inputs, 0)
        self.outputs = self._numbered(outputs, len(self.inputs))
        self.script = None
        self.semantic_data = None
        self.children = {}
        self.extra = {}

    @staticmethod
    def _numbered(ports, first):
        return {name: (number, *port) for number, (name, port) in enumerate((ports or {}).items(), first)}

    def content(self):
        return _typed(
            CORE + f"states.{self.kind}",
            name=self.name,
            state_id=self.state_id,
            description=None,
            income=_typed(ELEMENTS + "logical_port.Income"),
            outcomes={
                number: _typed(ELEMENTS + "logical_port.Outcome", name=name, outcome_id=number)
                for name, number in self.outcomes.items()
            },
            input_data_ports=_ports("data_port.InputDataPort", self.inputs),
            output_data_ports=_ports("data_port.OutputDataPort", self.outputs),
            **self.extra,
        )


def _ports(element, ports):
    return {
        number: _typed(
            ELEMENTS + element, data_port_id=number, name=name, data_type=_encoded(kind), default_value=_encoded(default)
        )
        for name, (number, kind, default) in ports.items()
    }


def execution(state_id, script, semantic_data=None, **interface):
    """A state with a script; a script without ``def`` is the body of ``execute``."""
    state = State("execution_state.ExecutionState", state_id, **interface)
    state.script = _script(script)
    state.semantic_data = semantic_data
    return state


def decider(script, **interface):
    """The child of a barrier that runs last."""
    state = State("barrier_concurrency_state.DeciderState", DECIDER, name="Decider", **interface)
    state.script = _script(script)
    return state


def _script(text):
    lines = text.strip("\n").splitlines()
    margin = min((len(line) - len(line.lstrip()) for line in lines if line.strip()), default=0)
    lines = [line[margin:].rstrip() for line in lines]
    if not any(line.startswith(("def ", "raw:")) for line in lines):
        lines = ["def execute(self, inputs, outputs, gvm):"] + [f"    {line}" if line else "" for line in lines]
    return "\n".join(line for line in lines if line != "raw:") + "\n"


def hierarchy(state_id, children, transitions, **rest):
    """A state that runs one child after the other."""
    return _container("hierarchy_state.HierarchyState", state_id, children, transitions, **rest)


def barrier(state_id, children, transitions, **rest):
    """A state that runs its children at the same time and then its decider."""
    return _container("barrier_concurrency_state.BarrierConcurrencyState", state_id, children, transitions, **rest)


def preemptive(state_id, children, transitions, **rest):
    """A state that runs its children at the same time until the first of them ends."""
    return _container("preemptive_concurrency_state.PreemptiveConcurrencyState", state_id, children, transitions, **rest)


def _container(kind, state_id, children, transitions, flows=(), scoped=None, **interface):
    state = State(kind, state_id, **interface)
    state.children = {child.state_id: child for child in children}
    variables = State._numbered(scoped, len(state.inputs) + len(state.outputs))
    state.extra = {
        "scoped_variables": _ports("scope.ScopedVariable", variables),
        "transitions": {
            number: _transition(number, state, text) for number, text in enumerate(transitions, 1)
        },
        "data_flows": {number: _flow(number, state, variables, text) for number, text in enumerate(flows, 1)},
    }
    return state


def _transition(number, container, text):
    source, target = (side.strip() for side in text.split("->"))
    from_state, _, outcome = source.partition(".")
    to_state, _, to_outcome = target.partition(".")
    return _typed(
        ELEMENTS + "transition.Transition",
        transition_id=number,
        from_state=from_state or None,
        from_outcome=container.children[from_state].outcomes[outcome] if from_state else None,
        to_state=to_state or container.state_id,
        to_outcome=container.outcomes[to_outcome] if to_outcome else None,
    )


def _flow(number, container, variables, text):
    source, target = (side.strip() for side in text.split("->"))
    from_state, from_key = _port(container, variables, source, is_source=True)
    to_state, to_key = _port(container, variables, target, is_source=False)
    return _typed(
        ELEMENTS + "data_flow.DataFlow",
        data_flow_id=number,
        from_state=from_state,
        from_key=from_key,
        to_state=to_state,
        to_key=to_key,
    )


def _port(container, variables, text, is_source):
    if text.startswith("$"):
        return container.state_id, variables[text[1:]][0]
    child, _, name = text.partition(".")
    owner = container.children[child] if child else container
    ports = owner.inputs if bool(child) != is_source else owner.outputs
    return owner.state_id, ports[name][0]


def library(state_id, root_key, name, content, inputs=None, outputs=None):
    """A state that is a machine of a library; ``content`` is the library's root, ``inputs`` and ``outputs`` set values."""
    state = State("library_state.LibraryState", state_id, name=name)
    state.outcomes = content.outcomes
    state.inputs, state.outputs = content.inputs, content.outputs
    state.library = {
        "library_path": root_key,
        "library_name": name,
        "version": "None",
        **_runtime("input", content.inputs, inputs or {}),
        **_runtime("output", content.outputs, outputs or {}),
    }
    return state


def _runtime(direction, ports, values):
    used = {number: values.get(name, default) for name, (number, _, default) in ports.items()}
    return {
        f"{direction}_data_port_runtime_values": {number: _encoded(value) for number, value in used.items()},
        f"use_runtime_value_{direction}_data_ports": {number: name in values for name, (number, *_) in ports.items()},
    }


def write(folder, root):
    """Writes the machine below ``folder``; returns the files' paths."""
    header = {"creation_time": CREATED, "state_machine_version": None, "used_rafcon_version": "2.5.2"}
    return [_dump(os.path.join(folder, "statemachine.json"), header)] + _write_state(folder, root)


def _write_state(folder, state):
    content = state.content()
    if hasattr(state, "library"):
        for key in ("description", "income", "input_data_ports", "output_data_ports"):
            del content[key]
        content.update(state.library)
    files = [_dump(os.path.join(folder, "core_data.json"), content)]
    if state.script is not None:
        files.append(_text(os.path.join(folder, "script.py"), state.script))
    if state.semantic_data:
        files.append(_dump(os.path.join(folder, "semantic_data.json"), state.semantic_data))
    for child in state.children.values():
        files += _write_state(os.path.join(folder, f"{child.name.replace(' ', '_')}_{child.state_id}"), child)
    return files


def _dump(path, content):
    return _text(path, json.dumps(content, indent=4, sort_keys=True, separators=(", ", ": ")))


def _text(path, text):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    return path
