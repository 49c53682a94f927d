"""Semantic data: what the user notes about a state, as nested dictionaries of texts."""

import json

from rafcon.utils.vividict import Vividict


class SemanticData:
    """The part of a state that offers its semantic data.

    Changes in place hold until the process ends, and go into the files of a machine that is being built. What is
    assigned as a whole changes the machine.
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
        """Brings what was changed in place into the machine."""
        if self._notes is not None and self._notes != self._facts["semantic_data"]:
            self._change("state.semantic_data", json.dumps(self._notes) if self._notes else None)

    def get_semantic_data(self, path_as_list):
        """The entry that a list of keys leads to; ``KeyError`` if there is none."""
        found = self._semantic_data
        for key in path_as_list:
            if key not in found:
                raise KeyError(f"{self} has no semantic data at the path {list(path_as_list)}")
            found = found[key]
        return found

    def add_semantic_data(self, path_as_list, value, key):
        """Puts a value into the dictionary at a path; returns the path of the entry."""
        self.get_semantic_data(path_as_list)[key] = value
        return list(path_as_list) + [key]

    def remove_semantic_data(self, path_as_list):
        """Removes the entry at a path and returns it; ``KeyError`` if there is none."""
        if not path_as_list:
            raise AttributeError("the path is empty, so it names no entry")
        found = self.get_semantic_data(path_as_list)
        del self.get_semantic_data(path_as_list[:-1])[path_as_list[-1]]
        return found
