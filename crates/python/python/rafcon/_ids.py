"""Names and ids of new elements. Numbers count through the process, as in the reference."""

import itertools
import random
import string

_names = itertools.count(1)
_transitions = itertools.count(1)
_data_flows = itertools.count(1)
_machines = itertools.count(1)


def state_name(cls):
    """Default name of a state."""
    return f"{cls.__name__} {state_number()}"


def state_number():
    """Next number for the name of a state."""
    return next(_names)


def state_id(taken=()):
    """Random id of six letters that is not taken."""
    while True:
        found = "".join(random.choice(string.ascii_uppercase) for _ in range(6))
        if found not in taken:
            return found


def machine_id():
    """Next id of a state machine."""
    return next(_machines)


def transition_id(is_taken):
    """Next id of a transition that is not taken in its container."""
    return next(found for found in _transitions if not is_taken(found))


def data_flow_id(is_taken):
    """Next id of a data flow that is not taken in its container."""
    return next(found for found in _data_flows if not is_taken(found))
