"""Decorators for methods that belong to a state machine."""

import functools
import threading

#: Number of decorated calls that currently hold the lock of a state machine.
global_lock_counter = 0
_counting = threading.Lock()


def lock_state_machine(method):
    """Decorator: hold the modification lock of the object's state machine during the method."""

    @functools.wraps(method)
    def wrapper(self, *arguments, **named):
        machine = _machine_of(self)
        if machine is None:
            return method(self, *arguments, **named)
        with machine.modification_lock():
            _count(1)
            try:
                return method(self, *arguments, **named)
            finally:
                _count(-1)

    return wrapper


def _count(difference):
    global global_lock_counter
    with _counting:
        global_lock_counter += difference


def _machine_of(thing):
    if hasattr(thing, "get_state_machine"):
        return thing.get_state_machine()
    if hasattr(thing, "modification_lock"):
        return thing
    parent = getattr(thing, "parent", None)
    return _machine_of(parent) if parent is not None else None
