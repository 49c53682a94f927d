"""Plugins: packages named by ``RAFCON_PLUGIN_PATH`` whose module ``hooks`` wants to be called."""

import importlib
import os
import sys

from rafcon.utils.log import get_logger


class Hooks:
    """The hooks of all plugins. ``active`` says whether any of them wants to be called around scripts."""

    def __init__(self):
        self.active = False
        self._modules = []

    def load(self):
        """Imports the plugins and calls ``pre_init`` and ``post_init``; one that fails is logged and left out."""
        self._modules = [module for module in map(_import, _folders()) if module is not None]
        self._call_guarded("pre_init")
        self._call_guarded("post_init", {})
        self.active = any(hasattr(module, name) for module in self._modules for name in ("pre_script", "post_script"))

    def pre_script(self):
        """Called before each script, on its thread. What a plugin raises goes to the state, as if its script had."""
        self._call("pre_script")

    def post_script(self):
        """Called after each script, on its thread."""
        self._call("post_script")

    def finished(self):
        """The state machine has ended."""
        self._call_guarded("on_state_machine_execution_finished")

    def shut_down(self):
        """The process ends."""
        self._call_guarded("pre_destruction")
        self._call_guarded("post_destruction")

    def _call(self, name, *arguments):
        for module in self._modules:
            function = getattr(module, name, None)
            if function is not None:
                function(*arguments)

    def _call_guarded(self, name, *arguments):
        for module in list(self._modules):
            try:
                getattr(module, name, lambda *_arguments: None)(*arguments)
            except Exception:
                get_logger("plugins").exception("the hook %s of %s failed", name, module.__name__)


def _folders():
    path = os.environ.get("RAFCON_PLUGIN_PATH", "")
    return [os.path.abspath(os.path.expanduser(folder)) for folder in path.split(os.pathsep) if folder]


def _import(folder):
    parent, name = os.path.split(folder)
    if parent not in sys.path:
        sys.path.insert(0, parent)
    try:
        return importlib.import_module(name + ".hooks")
    except Exception:
        get_logger("plugins").exception("the plugin %s is left out", folder)
        return None
