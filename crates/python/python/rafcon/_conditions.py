"""Conditions of breakpoints: Python expressions over the data of a state."""

import builtins
from collections.abc import Mapping
from functools import lru_cache
from types import MappingProxyType

from rafcon.core.global_variable_manager import global_variables

#: Maximum length of an error's text.
_TEXT_MAX = 200
#: Maximum number of cached compiled conditions.
_COMPILED_MAX = 1000


class Variables(Mapping):
    """Read-only mapping of the global variables by name, locked ones included."""

    def __getitem__(self, name):
        found, value, _kept = global_variables._resolve(name)
        if not found:
            raise KeyError(name)
        return value

    def __iter__(self):
        return iter(global_variables.get_all_keys())

    def __len__(self):
        return len(global_variables.get_all_keys())

    def get_variable(self, key, default=None):
        """Value of a variable, or ``default`` if there is no such variable, as in scripts."""
        return self.get(str(key), default)


def check(text, inputs, outputs, scoped, outcome):
    """Evaluate a condition. ``outputs`` and ``outcome`` (a name) are None before the state runs."""
    names = {
        "__builtins__": builtins.__dict__,
        "inputs": MappingProxyType(inputs),
        "outputs": MappingProxyType(outputs or {}),
        "scoped": MappingProxyType(scoped),
        "outcome": outcome,
        "gvm": Variables(),
    }
    return bool(eval(_code(text), names))


@lru_cache(maxsize=_COMPILED_MAX)
def _code(text):
    return compile(text.strip(), "<condition>", "eval")


def reason(error):
    """Short description of an error: its class and message."""
    text = getattr(error, "msg", None) if isinstance(error, SyntaxError) else str(error)
    return f"{type(error).__name__}: {text}"[:_TEXT_MAX] if text else type(error).__name__
