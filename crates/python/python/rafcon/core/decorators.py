"""Decorators for methods that belong to a state machine."""

import functools


def lock_state_machine(method):
    """Decorator: the method holds the modification lock of its object's state machine while it runs."""

    @functools.wraps(method)
    def wrapper(self, *arguments, **named):
        machine = _machine_of(self)
        if machine is None:
            return method(self, *arguments, **named)
        with machine.modification_lock():
            return method(self, *arguments, **named)

    return wrapper


def _machine_of(thing):
    if hasattr(thing, "get_state_machine"):
        return thing.get_state_machine()
    if hasattr(thing, "modification_lock"):
        return thing
    parent = getattr(thing, "parent", None)
    return _machine_of(parent) if parent is not None else None
