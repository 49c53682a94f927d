"""Ids of new elements, unique in this process."""

import itertools
import random
import string
import uuid

from rafcon import _ids

#: Number of letters in the id of a state.
STATE_ID_LENGTH = 6

#: Distinguishes the ids of this process from those of others.
experiment_id = str(uuid.uuid4())

_scripts = itertools.count(1)
_history_items = itertools.count(1)
_runs = itertools.count(1)
_given_global_ids = set()


def generate_state_machine_id():
    """Next id of a state machine."""
    return _ids.machine_id()


def generate_transition_id():
    """Next id of a transition."""
    return _ids.transition_id(lambda _id: False)


def generate_data_flow_id():
    """Next id of a data flow."""
    return _ids.data_flow_id(lambda _id: False)


def generate_state_name_id():
    """Next number for the name of a state."""
    return _ids.state_number()


def generate_script_id():
    """Next number of a script."""
    return next(_scripts)


def generate_data_port_id(used_data_port_ids):
    """Lowest id, from 0, that no port has."""
    return _free(used_data_port_ids)


def generate_outcome_id(used_outcome_ids):
    """Lowest id, from 0, that no outcome has."""
    return _free(used_outcome_ids)


def generate_semantic_data_key(used_semantic_keys):
    """Key that no entry has."""
    return next(key for key in map("semantic data key {}".format, itertools.count()) if key not in used_semantic_keys)


def state_id_generator(size=STATE_ID_LENGTH, chars=string.ascii_uppercase, used_state_ids=None):
    """Random letters that are not used yet."""
    return _by_chance(size, chars, used_state_ids or ())


def global_variable_id_generator(size=10, chars=string.ascii_uppercase):
    """Random letters that this function has not returned before."""
    found = _by_chance(size, chars, _given_global_ids)
    _given_global_ids.add(found)
    return found


def history_item_id_generator():
    """Id for an entry of a history."""
    return f"{experiment_id}.history_item_id.{next(_history_items):020}"


def run_id_generator():
    """Id for a run of a state."""
    return f"{experiment_id}.run_id.{next(_runs):020}"


def _free(used):
    return next(number for number in itertools.count() if number not in used)


def _by_chance(size, chars, used):
    while True:
        found = "".join(random.choice(chars) for _ in range(size))
        if found not in used:
            return found
