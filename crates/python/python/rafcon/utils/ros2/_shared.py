"""What handles keep from one run of a state to the next: made once for a name, with a lock for its users."""

import threading

_making = threading.Lock()


def shared(gvm, variable, name, make):
    """(object, lock) kept under a name in the dictionary of a global variable; ``make()`` makes a missing object."""
    with _making:
        kept = gvm.get_variable(variable)
        if kept is None:
            kept = {}
            gvm.set_variable(variable, kept, per_reference=True)
        if name not in kept:
            kept[name] = (make(), threading.Lock())
        return kept[name]


def forget(gvm, variable, name):
    """Takes an object out of the dictionary."""
    with _making:
        (gvm.get_variable(variable) or {}).pop(name, None)
