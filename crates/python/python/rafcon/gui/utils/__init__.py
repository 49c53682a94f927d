"""What scripts can use without a desktop: in a run, its dialogs too (:mod:`rafcon.gui.utils.dialog`)."""

from rafcon._lazy import submodules

__getattr__ = submodules(__name__)


def wait_for_gui():
    """Nothing to wait for."""
