"""What dialog scripts of old find where they look for a desktop: dialogs that are questions of the run.

Only modules that name ``rafcon.gui.utils`` and its dialogs get it, whether a desktop is installed or not: without its
main loop, which a run has not, they would wait for ever. Everything else that looks for a desktop finds what there is.
"""

import builtins
import types

from rafcon.gui.utils.dialog import _OK


class _Constants:
    """Names of a toolkit that only choose how a window looks: each is its own name."""

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
    """Calls at once what wants to be called on the thread of the desktop."""

    @staticmethod
    def idle_add(function, *arguments, **_priority):
        """Calls the function; 0 stands for the number of a source that is gone."""
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
    """The built-in names for such a module: ``import`` finds the toolkit of this one."""
    gi = _toolkit()

    def find(name, module=None, local_names=None, wanted=(), level=0):
        if level == 0 and (name == "gi" or name.startswith("gi.")):
            return gi.repository if wanted and name == "gi.repository" else gi
        return builtins.__import__(name, module, local_names, wanted, level)

    return {**builtins.__dict__, "__import__": find}
