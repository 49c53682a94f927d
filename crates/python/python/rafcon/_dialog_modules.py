"""Selects the modules that get dialogs instead of a desktop: scripts of a run, and their imports.

With ``RAFCON_DIALOGS=missing`` in the environment no module gets them, so that scripts fall back to
their code for a computer without a desktop.
"""

import importlib.machinery
import os
import sys

from rafcon import _objects
from rafcon._bridge import native


def are_present():
    """True if the caller, a script or a module that it imports, may open dialogs."""
    if os.environ.get("RAFCON_DIALOGS") == "missing":
        return False
    return _objects.is_host() or native.current_path() >= 0


def builtins_for(module):
    """Built-in names for the text of a script that may open dialogs; None for the usual ones."""
    if not (are_present() and "rafcon.gui.utils" in module and "dialog" in module):
        return None
    from rafcon import _desktop  # as late as this, for it takes long to load and is rarely wanted

    return _desktop.builtins_with_dialogs()


class _Finder(importlib.machinery.PathFinder):
    """Path finder that gives dialogs to the modules that open them."""

    @classmethod
    def find_spec(cls, fullname, path=None, target=None):
        spec = super().find_spec(fullname, path, target)
        loader = None if spec is None else spec.loader
        if type(loader) is importlib.machinery.SourceFileLoader and not loader.path.startswith(_INSTALLED):
            spec.loader = _Loader(loader.name, loader.path)
        return spec


class _Loader(importlib.machinery.SourceFileLoader):
    def exec_module(self, module):
        found = builtins_for(self.get_data(self.path).decode("utf-8", "replace"))
        if found is not None:
            module.__dict__["__builtins__"] = found
        super().exec_module(module)


#: Installed packages, which are numerous and open no dialogs of a run.
_INSTALLED = tuple({os.path.join(prefix, "lib") + os.sep for prefix in (sys.prefix, sys.base_prefix)})


def install():
    """Let modules that are imported from now on open dialogs."""
    places = [number for number, finder in enumerate(sys.meta_path) if finder is importlib.machinery.PathFinder]
    if places and os.environ.get("RAFCON_DIALOGS") != "missing":
        sys.meta_path[places[0]] = _Finder
