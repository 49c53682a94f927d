"""What a program calls that opens and runs a machine, in the order in which it does so.

``python3 -c`` programs of the reference begin with these; ``rafcon run`` needs none of it.
"""

import os

from rafcon.core.config import global_config
from rafcon.core.singleton import library_manager, state_machine_execution_engine, state_machine_manager
from rafcon.core.storage import storage


def _hooks():
    from rafcon._runtime import hooks

    return hooks


def pre_setup_plugins():
    """Loads the plugins of ``RAFCON_PLUGIN_PATH``."""
    _hooks().load()


def setup_environment():
    """Nothing to do: no path has to be set for this package."""


def setup_configuration(config_path):
    """Reads a ``config.yaml`` (a file, or the folder with it) and finds the libraries that it names."""
    folder, file = config_path, None
    if config_path is not None and not os.path.isdir(config_path):
        folder, file = os.path.split(config_path)
    global_config.load(config_file=file, path=folder or None)
    library_manager.initialize()


def open_state_machine(state_machine_path):
    """Loads a state machine and makes it known; returns it."""
    machine = storage.load_state_machine_from_path(state_machine_path)
    state_machine_manager.add_state_machine(machine)
    return machine


def start_state_machine(sm, start_state_path=None):
    """Starts a state machine that is known."""
    state_machine_execution_engine.start(sm.state_machine_id, start_state_path)


def wait_for_state_machine_finished(state_machine):
    """Waits for the end of the run."""
    state_machine_execution_engine.join()


def signal_handler(signal, frame=None):
    """Stops the machine that runs, in an orderly way."""
    if not state_machine_execution_engine.finished_or_stopped():
        state_machine_execution_engine.stop()
