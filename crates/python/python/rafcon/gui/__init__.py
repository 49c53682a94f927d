"""Placeholder for the former desktop program, which is not part of this package.

Importing its modules raises an error.
"""

import importlib.abc
import importlib.util
import sys

from rafcon import _dialog_modules

_PRESENT = ("rafcon.gui.utils",)
_DIALOGS = "rafcon.gui.utils.dialog"


class _NoDesktop(importlib.abc.MetaPathFinder):
    """Finder that rejects imports of ``rafcon.gui.…``, like an installation without a desktop."""

    def find_spec(self, fullname, path=None, target=None):
        if not fullname.startswith("rafcon.gui.") or fullname in _PRESENT:
            return None
        if fullname == _DIALOGS and _dialog_modules.are_present():
            return None
        if importlib.util.find_spec("gi") is None:
            raise ModuleNotFoundError("No module named 'gi'", name="gi")
        raise ModuleNotFoundError(
            f"No module named '{fullname}': the desktop program is not part of this rafcon", name=fullname
        )


sys.meta_path.insert(0, _NoDesktop())
