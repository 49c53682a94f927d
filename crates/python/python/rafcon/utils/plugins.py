"""Plugins: packages named by ``RAFCON_PLUGIN_PATH``. A run loads them by itself; these calls are for other programs."""

from rafcon._runtime import hooks

#: Name of the plugin to its package; the hooks are in its module ``hooks``.
plugin_dict = hooks.plugins


def load_plugins():
    """Imports the plugins; one that fails is logged and left out."""
    hooks.import_plugins()


def run_hook(hook_name, *args, **kwargs):
    """Calls a hook of every plugin that has it; what one raises comes here."""
    hooks.call(hook_name, *args, **kwargs)


def run_pre_inits():
    """Calls ``pre_init``; one that fails is logged."""
    hooks.call_guarded("pre_init")


def run_post_inits(setup_config):
    """Calls ``post_init`` with the arguments of the program, name to value; one that fails is logged."""
    hooks.call_guarded("post_init", setup_config)


def run_on_state_machine_execution_finished():
    """Calls ``on_state_machine_execution_finished``; one that fails is logged."""
    hooks.finished()
