"""Semantic data: a user's notes about a state, as nested dictionaries of texts."""

import json

from rafcon.utils.vividict import Vividict


class SemanticData:
    """Base class of states with semantic data.

    Changes in place last until the process ends; in a machine that is being built they are also
    saved. Assigning the whole dictionary changes the machine.
    """

    _notes = None

    @property
    def _semantic_data(self):
        if self._notes is None:
            self._notes = Vividict(self._facts["semantic_data"])
        return self._notes

    @property
    def semantic_data(self):
        """Nested dictionaries with ``str`` keys."""
        return self._semantic_data

    @semantic_data.setter
    def semantic_data(self, semantic_data):
        self._notes = Vividict(semantic_data)
        self._store_notes()

    def _store_notes(self):
        """Copy changes made in place to the machine."""
        if self._notes is not None and self._notes != self._facts["semantic_data"]:
            self._change("state.semantic_data", json.dumps(self._notes) if self._notes else None)

    def get_semantic_data(self, path_as_list):
        """Entry at a list of keys; ``KeyError`` if there is none."""
        found = self._semantic_data
        for key in path_as_list:
            if key not in found:
                raise KeyError(f"{self} has no semantic data at the path {list(path_as_list)}")
            found = found[key]
        return found

    def add_semantic_data(self, path_as_list, value, key):
        """Set a value in the dictionary at a path; return the path of the entry."""
        self.get_semantic_data(path_as_list)[key] = value
        return list(path_as_list) + [key]

    def remove_semantic_data(self, path_as_list):
        """Remove the entry at a path and return it; ``KeyError`` if there is none."""
        if not path_as_list:
            raise AttributeError("the path is empty, so it names no entry")
        found = self.get_semantic_data(path_as_list)
        del self.get_semantic_data(path_as_list[:-1])[path_as_list[-1]]
        return found
