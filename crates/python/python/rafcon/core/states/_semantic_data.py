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
                raise KeyError(key)
            found = found[key]
        return found

    def add_semantic_data(self, path_as_list, value, key=None):
        """Puts a value into the dictionary at a path; returns the path of the new entry.

        Without a key, or if there is such an entry already, a new key is made.
        """
        target = self.get_semantic_data(path_as_list)
        key = _free_key(target, key)
        target[key] = value
        return list(path_as_list) + [key]

    def remove_semantic_data(self, path_as_list):
        """Removes the entry at a path."""
        if not path_as_list:
            raise AttributeError("the path is empty, so it names no entry")
        del self.get_semantic_data(path_as_list[:-1])[path_as_list[-1]]


def _free_key(target, key):
    if key is not None and key not in target:
        return key
    stem = "semantic data key" if key is None else key
    number = 1
    while "%s %d" % (stem, number) in target:
        number += 1
    return "%s %d" % (stem, number)
