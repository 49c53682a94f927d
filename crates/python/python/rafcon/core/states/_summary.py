"""A state in numbers, as plain dictionaries, and as a hash; and names of the reference that mean little here."""

import os
import threading
from copy import copy

from rafcon.utils.hashable import Hashable

#: Polling interval, because the end of a state wakes no thread of the program.
_ASK_EVERY_S = 0.005


class StateSummary(Hashable):
    """What programs ask of a state as a whole; a part of every state."""

    def _states_inside(self):
        """The states directly inside; of a library state, those of the library."""
        copy = getattr(self, "state_copy", None)
        return list(getattr(self if copy is None else copy, "states", {}).values())

    def get_states_statistics(self, hierarchy_level):
        """How many states this is with all inside, and the deepest level, where this state is on ``hierarchy_level``."""
        below = [state.get_states_statistics(hierarchy_level + 1) for state in self._states_inside()]
        count = 1 + sum(found for found, _level in below)
        return count, max([hierarchy_level + 1] + [level for _found, level in below])

    def get_number_of_transitions(self):
        """How many transitions there are in this state and all inside."""
        return len(getattr(self, "transitions", ())) + sum(state.get_number_of_transitions() for state in self._states_inside())

    def get_number_of_data_flows(self):
        """How many data flows there are in this state and all inside."""
        return len(getattr(self, "data_flows", ())) + sum(state.get_number_of_data_flows() for state in self._states_inside())

    def get_storage_path(self):
        """The folder of the state, relative to that of its machine, as it is saved."""
        from rafcon.core.storage.storage import get_storage_id_for_state

        parent = self.parent
        if getattr(parent, "parent", None) is None and not hasattr(parent, "state_id"):
            return ""
        above = parent.get_storage_path()
        # The root of a library has no folder in the machine's folder.
        return above if self.is_root_state_of_library else os.path.join(above, get_storage_id_for_state(self))

    def get_temp_file_system_path(self):
        """A folder for files of the state that are not saved; it is not made."""
        from rafcon.utils.constants import RAFCON_TEMP_PATH_STORAGE

        return os.path.join(RAFCON_TEMP_PATH_STORAGE, self.get_storage_path())

    def to_dict(self):
        """The parts of the state, by their names."""
        names = ("name", "state_id", "description", "input_data_ports", "output_data_ports", "income", "outcomes")
        parts = (*names, "transitions", "data_flows", "scoped_variables")
        return {name: getattr(self, name) for name in parts if hasattr(self, name)}

    @staticmethod
    def state_to_dict(state):
        """The same as ``state.to_dict()``."""
        return state.to_dict()

    @classmethod
    def from_dict(cls, dictionary):
        """A new state with copies of the parts in a dictionary that ``to_dict`` made."""
        named = {name: dictionary[name] for name in ("name", "state_id")}
        for name in ("input_data_ports", "output_data_ports", "outcomes", "scoped_variables"):
            if name in dictionary:
                named[name] = {key: copy(element) for key, element in dictionary[name].items()}
        state = cls(**named)
        state.description = dictionary.get("description")
        return state

    def update_hash(self, obj_hash):
        """Adds what the state is made of, with all inside, to a hash; layout and notes do not count."""
        facts = self._facts
        own = ("kind", "name", "state_id", "outcomes", "inputs", "outputs", "scoped_variables", "transitions", "data_flows")
        self.update_hash_from_dict(obj_hash, {name: facts[name] for name in own})
        self.update_hash_from_dict(obj_hash, facts["script"])
        self.update_hash_from_dict(obj_hash, {state.state_id: state for state in self._states_inside()})

    def join(self):
        """Waits until the state does not run any more."""
        pause = threading.Event()
        while self.active:
            pause.wait(_ASK_EVERY_S)

    @property
    def _execution_counter(self):
        """How often the state was entered in this run; tests of the reference wait for it to change."""
        return self._live()["run_count"]

    def destroy(self, recursive=True):
        """Means nothing: what nobody holds goes by itself."""
