"""The one door to the compiled module ``rafcon._native``.

Everything that asks the running machine something imports ``native`` from here. Without the compiled module, or in a
plain interpreter, ``native`` answers every question with :class:`NoRunningMachine`.
"""

import importlib


class NoRunningMachine(RuntimeError):
    """Asked for something that only exists while a state machine runs."""


class _Absent:
    """Stands in for the compiled module where there is none."""

    def __getattr__(self, name):
        raise NoRunningMachine(
            f"there is no running state machine and no compiled module in this interpreter, so `rafcon` cannot answer "
            f"`{name}`; start the machine with `rafcon run PATH`, or install the wheel to build machines"
        )

    def current_path(self):
        """No state runs on any thread here."""
        return -1


def _load():
    try:
        return importlib.import_module("rafcon._native")
    except ImportError:
        return _Absent()


native = _load()
