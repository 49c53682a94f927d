"""Python objects of states: selection of the class, and lookup of other objects.

Rust keeps one object for each state of the running machine, and creates it here on first use.
"""

from rafcon._bridge import native

_KINDS = {
    "execution": ("rafcon.core.states.execution_state", "ExecutionState"),
    "decider": ("rafcon.core.states.barrier_concurrency_state", "DeciderState"),
    "hierarchy": ("rafcon.core.states.hierarchy_state", "HierarchyState"),
    "barrier": ("rafcon.core.states.barrier_concurrency_state", "BarrierConcurrencyState"),
    "preemptive": ("rafcon.core.states.preemptive_concurrency_state", "PreemptiveConcurrencyState"),
    "library": ("rafcon.core.states.library_state", "LibraryState"),
}
_classes = {}
_machine = []
_host = []


def new_state(place, kind, signals):
    """Create the object for the state at an index; its kind determines the class."""
    state = blank_state(kind)
    state._bind(place, signals)
    return state


def blank_state(kind):
    """Create an object of the class for a kind, not yet bound to a state."""
    cls = _classes.get(kind) or _class(kind)
    return cls.__new__(cls)


def prepare(kinds):
    """Load the classes of these kinds, so that no state waits for an import."""
    for kind in kinds:
        _classes.get(kind) or _class(kind)


def _class(kind):
    import importlib

    module, name = _KINDS[kind]
    cls = _classes[kind] = getattr(importlib.import_module(module), name)
    return cls


def state(place):
    """Object for the state at an index; each call returns this one object."""
    return native.state_object(place)


def current_state():
    """Object of the state whose script runs on this thread, or None."""
    place = native.current_path()
    return state(place) if place >= 0 else None


def machine():
    """Object for the running state machine; each call returns this one object."""
    if not _machine:
        from rafcon.core.state_machine import StateMachine

        found = StateMachine.__new__(StateMachine)
        found._bind(native.machine())
        _machine.append(found)
    return _machine[0]


def become_host():
    """Mark this process as started to run one machine."""
    _host.append(True)


def is_host():
    """True if this process was started to run one machine."""
    return bool(_host)


def forget_machine():
    """Forget the object of the running machine, because another machine will run."""
    _machine.clear()


def machine_or_none():
    """Object for the running state machine; None if no machine runs."""
    try:
        return machine()
    except RuntimeError:
        return None


def port_type(name):
    """Type of a port, or its name if it cannot be imported here."""
    from rafcon._types import resolve_type

    try:
        return resolve_type(name)
    except (ImportError, AttributeError, TypeError, ValueError):
        return name
