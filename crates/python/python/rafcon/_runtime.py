"""Functions that the compiled module calls: the only names that Rust uses.

Every function is called with the GIL held and never waits.
"""

import rafcon.utils.log  # noqa: F401, the level VERBOSE exists from here on
from rafcon import _capture, _console, _dialog_modules, _fork, _logging, _objects, _printed_errors
from rafcon._capture import flush_all, flush_capture, pending
from rafcon._conditions import check
from rafcon._conditions import reason as why
from rafcon._hooks import Hooks
from rafcon._keeping import pickle, unpickle
from rafcon._threads import adopt as adopt_thread
from rafcon._tracebacks import format_error
from rafcon._types import convert, resolve_type
from rafcon._values import decode, decode_plain, encode
from rafcon.core.custom_exceptions import StatePreempted
from rafcon.core.global_variable_manager import global_variables as global_variable_manager

__all__ = [
    "StatePreempted",
    "adopt_thread",
    "builtins_for",
    "check",
    "configure",
    "convert",
    "decode",
    "decode_plain",
    "encode",
    "encode_globals",
    "flush_all",
    "flush_capture",
    "format_error",
    "global_variable_manager",
    "hooks",
    "install_capture",
    "keep_globals",
    "note_globals",
    "machine",
    "new_state",
    "pending",
    "pickle",
    "prepare",
    "resolve_global",
    "resolve_type",
    "restore_global",
    "set_verdicts",
    "state",
    "unpickle",
    "why",
]

#: The hooks of the user's plugins.
hooks = Hooks()

builtins_for = _dialog_modules.builtins_for
new_state = _objects.new_state
prepare = _objects.prepare
state = _objects.state
machine = _objects.machine
resolve_global = global_variable_manager._resolve
restore_global = global_variable_manager._restore
keep_globals = global_variable_manager._keep_in
note_globals = global_variable_manager._note_all


def set_verdicts(decider, verdicts):
    """Pass a decider the results of its barrier's states.

    Each result is (id, name, outcome id, outcome name, error or None).
    """
    decider._set_verdicts(verdicts)


def encode_globals():
    """Global variables as JSON values, by name."""
    return {name: encode(value) for name, value in global_variable_manager._values().items()}


def configure(values):
    """Set the active configuration: key of ``config.yaml`` to value."""
    from rafcon.core.config import global_config

    global_config._replace(values)


def install_capture():
    """Send output and log records to the running machine, in a process that only runs a machine."""
    _objects.become_host()
    _capture.install()
    _printed_errors.install()
    _logging.install()
    _fork.install()
    _dialog_modules.install()
    _console.install()
