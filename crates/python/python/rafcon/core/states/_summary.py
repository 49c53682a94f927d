"""Statistics, dictionaries and hashes of a state, and rarely used methods of the reference."""

import os
import threading
from copy import copy

from rafcon.utils.hashable import Hashable

#: Polling interval, because the end of a state wakes no thread of the program.
_ASK_EVERY_S = 0.005


class StateSummary(Hashable):
    """Base class of states with methods that summarize a state."""

    def _states_inside(self):
        """States directly inside; for a library state, those of the library."""
        copy = getattr(self, "state_copy", None)
        return list(getattr(self if copy is None else copy, "states", {}).values())

    def get_states_statistics(self, hierarchy_level):
        """Number of states (this one and all inside), and the deepest level plus 1.

        ``hierarchy_level`` is the level of this state.
        """
        below = [state.get_states_statistics(hierarchy_level + 1) for state in self._states_inside()]
        count = 1 + sum(found for found, _level in below)
        return count, max([hierarchy_level + 1] + [level for _found, level in below])

    def get_number_of_transitions(self):
        """Number of transitions in this state and all states inside."""
        return len(getattr(self, "transitions", ())) + sum(state.get_number_of_transitions() for state in self._states_inside())

    def get_number_of_data_flows(self):
        """Number of data flows in this state and all states inside."""
        return len(getattr(self, "data_flows", ())) + sum(state.get_number_of_data_flows() for state in self._states_inside())

    def get_storage_path(self):
        """Folder in which the state is saved, relative to that of its machine."""
        from rafcon.core.storage.storage import get_storage_id_for_state

        parent = self.parent
        if getattr(parent, "parent", None) is None and not hasattr(parent, "state_id"):
            return ""
        above = parent.get_storage_path()
        # The root of a library has no folder in the machine's folder.
        return above if self.is_root_state_of_library else os.path.join(above, get_storage_id_for_state(self))

    def get_temp_file_system_path(self):
        """Path of a folder for temporary files of the state; the folder is not created."""
        from rafcon.utils.constants import RAFCON_TEMP_PATH_STORAGE

        return os.path.join(RAFCON_TEMP_PATH_STORAGE, self.get_storage_path())

    def to_dict(self):
        """Parts of the state by name."""
        names = ("name", "state_id", "description", "input_data_ports", "output_data_ports", "income", "outcomes")
        parts = (*names, "transitions", "data_flows", "scoped_variables")
        return {name: getattr(self, name) for name in parts if hasattr(self, name)}

    @staticmethod
    def state_to_dict(state):
        """Equivalent to ``state.to_dict()``."""
        return state.to_dict()

    @classmethod
    def from_dict(cls, dictionary):
        """Create a state from copies of the parts in a dictionary of ``to_dict``."""
        named = {name: dictionary[name] for name in ("name", "state_id")}
        for name in ("input_data_ports", "output_data_ports", "outcomes", "scoped_variables"):
            if name in dictionary:
                named[name] = {key: copy(element) for key, element in dictionary[name].items()}
        state = cls(**named)
        state.description = dictionary.get("description")
        return state

    def update_hash(self, obj_hash):
        """Add the content of the state, with all inside, to a hash.

        Layout, description and semantic data are not included.
        """
        facts = self._facts
        own = ("kind", "name", "state_id", "outcomes", "inputs", "outputs", "scoped_variables", "transitions", "data_flows")
        self.update_hash_from_dict(obj_hash, {name: facts[name] for name in own})
        self.update_hash_from_dict(obj_hash, facts["script"])
        self.update_hash_from_dict(obj_hash, {state.state_id: state for state in self._states_inside()})

    def join(self):
        """Wait until the state is no longer active."""
        pause = threading.Event()
        while self.active:
            pause.wait(_ASK_EVERY_S)

    @property
    def _execution_counter(self):
        """Number of entries in this run; tests of the reference wait for it to change."""
        return self._live()["run_count"]

    def destroy(self, recursive=True):
        """Do nothing: Python releases unused objects."""
