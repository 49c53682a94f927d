"""Functions with which a program opens and runs a machine, in the order of their use.

``python3 -m rafcon.core.start -o MACHINE`` is such a program. It runs a machine in its own process
and has the exit codes of ``rafcon run``. ``rafcon run`` also keeps a journal and survives a crash
of a script.
"""

import argparse
import os
import signal as signals
import sys
import threading

from rafcon.core.config import global_config
from rafcon.core.singleton import (
    argument_parser,
    library_manager,
    state_machine_execution_engine,
    state_machine_manager,
)
from rafcon.core.storage import storage
from rafcon.utils.log import get_logger

logger = get_logger("start.core")
_CONFIG = os.path.join("~", ".config", "rafcon")
_LOGS = os.path.join("~", ".log", "rafcon")
#: The exit codes of ``rafcon run`` for outcomes that are not 0; another outcome is 3.
_EXIT_CODES = {0: 0, -1: 4, -2: 5}
_NO_RUN = 1
#: Timeout (s) for the end of a stopped root.
_STOP_WITHIN_S = 3


def _hooks():
    from rafcon._runtime import hooks

    return hooks


# ---- the command line


def setup_argument_parser():
    """Add the options of a start to ``argument_parser`` of :mod:`rafcon.core.singleton`; return it.

    A plugin adds its own options in ``pre_init``, and receives their values in the argument of
    ``post_init``.
    """
    if any(action.dest == "state_machine_path" for action in argument_parser._actions):
        return argument_parser
    add = argument_parser.add_argument
    add(
        *("-o", "--open"),
        dest="state_machine_path",
        metavar="path",
        nargs="+",
        type=parse_state_machine_path,
        help="folders of state machines; the first is run",
    )
    add(
        *("-c", "--config"),
        dest="config_path",
        metavar="path",
        nargs="?",
        type=_parse_config_path,
        default=os.path.expanduser(_CONFIG),
        help="a config.yaml, or the folder with it; 'None' for none. Default: %(default)s",
    )
    add(
        *("-r", "--remote"),
        dest="remote",
        action="store_true",
        help="open the machine without starting it; a program or plugin starts it later",
    )
    add(
        *("-s", "--start_state_path"),
        dest="start_state_path",
        metavar="path",
        nargs="?",
        help="the state to start at: the ids from the root down, joined by /",
    )
    _add_profiling(add)
    return argument_parser


def _add_profiling(add):
    """Add options of old start scripts, which have no effect here."""
    unused = "accepted for old start scripts; measure with tools of Python"
    add("-mp", "--memory-profiling", action="store_true", help=unused)
    add("-mpp", "--memory-profiling-path", metavar="path", nargs="?", default=os.path.expanduser(_LOGS), help=unused)
    add("-mpi", "--memory-profiling-interval", type=int, default=10, help=unused)
    add("-mppr", "--memory-profiling-print", action="store_true", help=unused)


def parse_state_machine_path(path):
    """Return the path of a state machine; ``argparse.ArgumentTypeError`` if it contains none."""
    for file in (storage.STATEMACHINE_FILE, "statemachine.yaml"):
        if os.path.isfile(os.path.join(path, file)):
            return path
    raise argparse.ArgumentTypeError(f"there is no state machine in {path}: no {storage.STATEMACHINE_FILE}")


def _parse_config_path(path):
    if path is None or path == "None":
        return None
    if not os.path.exists(path) and path != os.path.expanduser(_CONFIG):
        raise argparse.ArgumentTypeError(f"there is no configuration {path}")
    return path


def parse_arguments(arguments):
    """Options in a list of arguments, name to value; ``ValueError`` for invalid arguments."""
    parser = setup_argument_parser()
    parser.error = _raise
    try:
        return vars(parser.parse_args(arguments))
    finally:
        del parser.error


def _raise(message):
    raise ValueError(message)


# ---- the steps of a start


def pre_setup_plugins():
    """Load the plugins of ``RAFCON_PLUGIN_PATH`` and call their ``pre_init``."""
    _hooks().load()


def setup_environment():
    """Do nothing: this package needs no paths."""


def setup_configuration(config_path):
    """Read a ``config.yaml`` (the file or its folder), and forget the libraries that were read."""
    if config_path is not None:
        folder, file = config_path, None
        if not os.path.isdir(config_path) and config_path != os.path.expanduser(_CONFIG):
            folder, file = os.path.split(config_path)
        global_config.load(config_file=file, path=folder or None)
    library_manager.initialize()


def post_setup_plugins(parser_result):
    """Call ``post_init`` of the plugins with the parsed options, a namespace or a dictionary."""
    options = parser_result if isinstance(parser_result, dict) else vars(parser_result)
    _hooks().call_guarded("post_init", options)


def open_state_machine(state_machine_path):
    """Load a state machine, register it with the manager, and return it."""
    machine = storage.load_state_machine_from_path(state_machine_path)
    state_machine_manager.add_state_machine(machine)
    return machine


def start_state_machine(sm, start_state_path=None):
    """Start a state machine that is registered with the manager."""
    state_machine_execution_engine.start(sm.state_machine_id, start_state_path)


def wait_for_state_machine_finished(state_machine):
    """Wait for the end of the run."""
    # Wait in short intervals, so that signal handlers can run.
    while not state_machine_execution_engine.join(0.5):
        if state_machine_execution_engine.finished_or_stopped():
            return


def register_signal_handlers(callback):
    """Call a function on SIGHUP, SIGINT and SIGTERM; only allowed on the main thread."""
    for name in ("SIGHUP", "SIGINT", "SIGTERM"):
        signals.signal(getattr(signals, name), callback)


def signal_handler(signal, frame=None):
    """Stop the running machine in an orderly manner."""
    from rafcon.core import singleton

    singleton.shut_down_signal = signal
    if not state_machine_execution_engine.finished_or_stopped():
        state_machine_execution_engine.stop()


def reactor_required():
    """True if a plugin has imported Twisted, whose reactor then runs in the main thread."""
    return "twisted" in sys.modules


def stop_reactor_on_state_machine_finish(state_machine):
    """Wait for the end of the run, then stop Twisted's reactor."""
    wait_for_state_machine_finished(state_machine)
    from twisted.internet import reactor

    if reactor.running:
        reactor.callFromThread(reactor.stop)


def main(optional_args=None):
    """Run the machine that the command line (or a list of arguments) names; return the exit code.

    0 if the machine ended by outcome 0, 3 by another one, 4 by *aborted*, 5 by *preempted*, and 1
    if there was no run.
    """
    if threading.current_thread() is threading.main_thread():
        register_signal_handlers(signal_handler)
    pre_setup_plugins()
    setup_environment()
    options = setup_argument_parser().parse_args(optional_args)
    if not options.state_machine_path:
        argument_parser.error("no state machine is named; name one with -o")
    try:
        setup_configuration(options.config_path)
        post_setup_plugins(options)
        machines = [open_state_machine(path) for path in options.state_machine_path]
        if not options.remote:
            start_state_machine(machines[0], options.start_state_path)
        _wait(machines[0], options.remote)
    except (AttributeError, OSError, RuntimeError, ValueError) as error:
        logger.error("%s", error)
        return _NO_RUN
    finally:
        _hooks().shut_down()
    outcome = machines[0].root_state.final_outcome
    return _NO_RUN if outcome is None else _EXIT_CODES.get(outcome.outcome_id, 3)


def _wait(machine, is_remote):
    if reactor_required():
        _run_reactor(machine)
    elif is_remote:
        _wait_for_signal()
        state_machine_execution_engine.join(_STOP_WITHIN_S)
    else:
        wait_for_state_machine_finished(machine)


def _wait_for_signal():
    """Wait for a signal, while a plugin or another thread may start the machine."""
    from rafcon.core import singleton

    pause = threading.Event()
    while singleton.shut_down_signal is None:
        pause.wait(0.5)


def _run_reactor(machine):
    from twisted.internet import reactor

    # Start it only when the reactor runs: a reactor stopped earlier would never end.
    end = threading.Thread(target=stop_reactor_on_state_machine_finish, args=(machine,), daemon=True)
    reactor.callWhenRunning(end.start)
    reactor.run()


if __name__ == "__main__":
    import logging

    logging.basicConfig(level=logging.INFO, format="%(asctime)s %(levelname)s %(name)s: %(message)s")
    sys.exit(main())
