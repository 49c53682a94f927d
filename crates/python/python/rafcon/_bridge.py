"""Access to the compiled module ``rafcon._native``.

All code that queries the running machine imports ``native`` from here. In a plain interpreter,
queries of the running machine raise ``RuntimeError``. Without the compiled module, ``native`` only
has ``current_path``; everything else raises :class:`NoRunningMachine`, a ``RuntimeError``.
"""

import importlib


class NoRunningMachine(RuntimeError):
    """Something was requested that only exists while a state machine runs."""


class _Absent:
    """Replacement for the compiled module if it is not installed."""

    def __getattr__(self, name):
        raise NoRunningMachine(
            f"there is no running state machine and no compiled module in this interpreter, so `rafcon` cannot answer "
            f"`{name}`; start the machine with `rafcon run PATH`, or install the wheel to build machines"
        )

    def current_path(self):
        """Return -1: no state runs on any thread."""
        return -1


def _load():
    try:
        return importlib.import_module("rafcon._native")
    except ImportError:
        return _Absent()


native = _load()
