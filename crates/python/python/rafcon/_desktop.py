"""Replacement for the GTK modules that old dialog scripts import: dialogs are questions of the run.

Only modules that name ``rafcon.gui.utils`` and its dialogs get it, whether a desktop is installed
or not. With the real toolkit they would wait forever, because a run has no GTK main loop. All other
modules import the installed toolkit.
"""

import builtins
import types

from rafcon.gui.utils.dialog import _OK


class _Constants:
    """Constants of a toolkit that only affect the appearance of a window. Each is its own name."""

    def __init__(self, name):
        self._name = name

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return _Constants(f"{self._name}.{name}")

    def __or__(self, other):
        return self

    def __repr__(self):
        return self._name


class _Responses(_Constants):
    OK = _OK


class _GLib:
    """Replacement for ``GLib`` that calls functions at once, not on the desktop's thread."""

    @staticmethod
    def idle_add(function, *arguments, **_priority):
        """Call the function; return 0 as the id of a source that has been removed."""
        function(*arguments)
        return 0


def _toolkit():
    gtk = types.SimpleNamespace(
        DialogFlags=_Constants("DialogFlags"),
        MessageType=_Constants("MessageType"),
        ResponseType=_Responses("ResponseType"),
    )
    gdk = types.SimpleNamespace(keyval_name=lambda _number: "")
    repository = types.SimpleNamespace(GLib=_GLib, Gtk=gtk, Gdk=gdk)
    return types.SimpleNamespace(repository=repository, require_version=lambda _name, _version: None)


def builtins_with_dialogs():
    """Built-in names for such a module: ``import gi`` returns the toolkit of this module."""
    gi = _toolkit()

    def find(name, module=None, local_names=None, wanted=(), level=0):
        if level == 0 and (name == "gi" or name.startswith("gi.")):
            return gi.repository if wanted and name == "gi.repository" else gi
        return builtins.__import__(name, module, local_names, wanted, level)

    return {**builtins.__dict__, "__import__": find}
