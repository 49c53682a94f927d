"""Plugins: packages in ``RAFCON_PLUGIN_PATH``, loaded automatically in runs.

The functions here are for other programs.
"""

from rafcon._runtime import hooks

#: Name of the plugin to its package; the hooks are in its module ``hooks``.
plugin_dict = hooks.plugins


def load_plugins():
    """Import the plugins; one that fails is logged and skipped."""
    hooks.import_plugins()


def run_hook(hook_name, *args, **kwargs):
    """Call a hook of every plugin that has it, and pass on its exceptions."""
    hooks.call(hook_name, *args, **kwargs)


def run_pre_inits():
    """Call ``pre_init`` of each plugin, and log exceptions."""
    hooks.call_guarded("pre_init")


def run_post_inits(setup_config):
    """Call ``post_init`` with the arguments of the program, name to value, and log exceptions."""
    hooks.call_guarded("post_init", setup_config)


def run_on_state_machine_execution_finished():
    """Call ``on_state_machine_execution_finished`` of each plugin, and log exceptions."""
    hooks.finished()
