"""The objects that stand for states: which class, and how one finds another.

Rust keeps one object for each place in the machine and makes it here the first time it is wanted.
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
    """A new object for the state at a place; its class follows its kind."""
    state = blank_state(kind)
    state._bind(place, signals)
    return state


def blank_state(kind):
    """An object of the class for a kind that stands nowhere yet."""
    cls = _classes.get(kind) or _class(kind)
    return cls.__new__(cls)


def prepare(kinds):
    """Loads the classes of these kinds, so that no state waits for its own."""
    for kind in kinds:
        _classes.get(kind) or _class(kind)


def _class(kind):
    import importlib

    module, name = _KINDS[kind]
    cls = _classes[kind] = getattr(importlib.import_module(module), name)
    return cls


def state(place):
    """The object for the state at a place, always the same one."""
    return native.state_object(place)


def current_state():
    """The object of the state whose script runs on this thread, or None."""
    place = native.current_path()
    return state(place) if place >= 0 else None


def machine():
    """The object for the running state machine, always the same one."""
    if not _machine:
        from rafcon.core.state_machine import StateMachine

        found = StateMachine.__new__(StateMachine)
        found._bind(native.machine())
        _machine.append(found)
    return _machine[0]


def become_host():
    """This process was started to run one machine."""
    _host.append(True)


def is_host():
    """Whether this process was started to run one machine."""
    return bool(_host)


def forget_machine():
    """Another machine is going to run."""
    _machine.clear()


def machine_or_none():
    """As :func:`machine`; None where no state machine runs."""
    try:
        return machine()
    except RuntimeError:
        return None


def port_type(name):
    """The type of a port; its name, where it cannot be imported here."""
    from rafcon._types import resolve_type

    try:
        return resolve_type(name)
    except (ImportError, AttributeError, TypeError, ValueError):
        return name
