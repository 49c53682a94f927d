"""Plugins: packages in ``RAFCON_PLUGIN_PATH`` with a module ``hooks``.

A plugin that fails to load or raises in a guarded hook never ends the run: the error is logged and
the plugin or hook is skipped.
"""

import importlib
import os
import re
import shlex
import sys

from rafcon.utils.log import get_logger

logger = get_logger("plugins")

#: Hooks of the desktop program and its engine that are never called here, with their replacements.
_NEVER_CALLED = {
    "main_window_setup": "there is no window; the page shows runs, and other programs follow them through the server",
    "post_state_editor_register_view": "there is no window; the page shows what a state is made of",
    "register_execution_history_consumer": "the journal keeps the history; read it with `rafcon export` or through the server",
    "state_thread_joined": "a state has no thread of its own; `post_script` is called after each script",
}


#: Matches an error about functions through which the reference runs states.
_ENGINE = re.compile(
    r"'(Script|\w*State)' (object )?has no attribute "
    r"'(execute|compiled_module|_?compile_and_load_module|run|start|setup_run|concurrency_queue|thread)'"
)


class Hooks:
    """Hooks of all plugins. ``active`` is True if a plugin has a hook around scripts."""

    def __init__(self):
        self.active = False
        #: Name of the plugin to its package; the hooks are in its module ``hooks``.
        self.plugins = {}

    def load(self):
        """Import the plugins and call ``pre_init``."""
        self.import_plugins()
        self.call_guarded("pre_init")

    def import_plugins(self):
        """Import the plugins."""
        self.plugins.clear()
        for folder in _folders():
            package = _import(folder)
            if package is not None:
                self.plugins[os.path.basename(folder)] = package
                _name_what_is_never_called(package)
        self.active = any(hasattr(hooks, name) for hooks in self._modules() for name in ("pre_script", "post_script"))

    def begin(self, machine, config, start_state_path):
        """Call ``post_init`` with the arguments of the run: machine, configuration, start state."""
        if self.plugins:
            self.call_guarded("post_init", _arguments(machine, config, start_state_path))

    def pre_script(self):
        """Run the hooks before a script, on its thread. Their exceptions count as the script's."""
        self.call("pre_script")

    def post_script(self):
        """Run the hooks after a script, on its thread."""
        self.call("post_script")

    def finished(self):
        """Run the hooks for the end of the state machine."""
        self.call_guarded("on_state_machine_execution_finished")

    def shut_down(self):
        """Run the hooks for the end of the process."""
        self.call_guarded("pre_destruction")
        self.call_guarded("post_destruction")

    def call(self, name, *arguments, **named):
        """Call a hook of every plugin that has it."""
        for module in self._modules():
            function = getattr(module, name, None)
            if function is not None:
                function(*arguments, **named)

    def call_guarded(self, name, *arguments):
        """Call a hook of every plugin that has it, and log what it raises."""
        for module in self._modules():
            try:
                getattr(module, name, lambda *_arguments: None)(*arguments)
            except (Exception, SystemExit) as error:
                logger.exception("the hook %s of %s failed%s", name, module.__name__, _advice(error))

    def _modules(self):
        return [package.hooks for package in self.plugins.values()]


def _advice(error):
    """Advice for a hook that failed because it replaces functions of the engine."""
    if isinstance(error, AttributeError) and _ENGINE.search(str(error)):
        return (
            ": states run outside Python, so their functions cannot be replaced; "
            "the hooks `pre_script` and `post_script` are called around each script"
        )
    return ""


def _folders():
    path = os.environ.get("RAFCON_PLUGIN_PATH", "")
    folders = [os.path.expanduser(os.path.expandvars(folder.strip())) for folder in path.split(os.pathsep)]
    return [os.path.abspath(folder) for folder in folders if folder]


def _import(folder):
    parent, name = os.path.split(folder)
    if parent not in sys.path:
        sys.path.insert(0, parent)
    try:
        importlib.import_module(name + ".hooks")
        return sys.modules[name]
    except (Exception, SystemExit):
        logger.exception("the plugin %s is left out", folder)
        return None


def _name_what_is_never_called(package):
    for name, instead in _NEVER_CALLED.items():
        if hasattr(package.hooks, name):
            logger.info("the hook %s of %s is never called: %s", name, package.__name__, instead)


def _arguments(machine, config, start_state_path):
    """Options of the command line, including those that plugins have added: name to value.

    A run has no command line of its own. Options of plugins come from ``RAFCON_PLUGIN_ARGUMENTS``.
    """
    from rafcon.core.start import parse_arguments

    try:
        found = parse_arguments(shlex.split(os.environ.get("RAFCON_PLUGIN_ARGUMENTS", "")))
    except (ValueError, SystemExit) as error:
        logger.error("cannot read RAFCON_PLUGIN_ARGUMENTS, so plugins get no options: %s", error)
        found = {}
    found.update(state_machine_path=[machine], start_state_path=start_state_path)
    if config is not None:
        found["config_path"] = config
    return found
