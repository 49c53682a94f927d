"""Semantic data: what the user notes about a state, as nested dictionaries of texts."""

from functools import cached_property

from rafcon.core._refusals import fixed
from rafcon.utils.vividict import Vividict


class SemanticData:
    """The part of a state that offers its semantic data. Changes hold until the process ends."""

    @cached_property
    def _semantic_data(self):
        return Vividict(self._facts["semantic_data"])

    @fixed
    def semantic_data(self):
        """Nested dictionaries with ``str`` keys."""
        return self._semantic_data

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
