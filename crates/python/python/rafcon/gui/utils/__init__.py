"""Helpers for scripts without a desktop; in a run also :mod:`rafcon.gui.utils.dialog`."""

from rafcon._lazy import submodules

__getattr__ = submodules(__name__)


def wait_for_gui():
    """Return at once: there is no window."""
