"""Separates a forked child from the run: it is a process of its own.

Scripts fork with ``os.fork`` and ``multiprocessing``. The child prints and logs to the original
streams, and has its own copy of the global variables. Signals that end a process end the child; in
the parent the runner handles them.
"""

import os
import signal
import sys
import threading

from rafcon import _capture, _logging
from rafcon.core.global_variable_manager import global_variables

#: Signals with handlers of the runner.
_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


_masks = threading.local()


def install():
    """Separate every child forked from now on from the run."""
    os.register_at_fork(before=_before, after_in_parent=_in_parent, after_in_child=_in_child)


def install_in_program():
    """Prepare forks of a program that runs machines itself; keep its output and signals."""
    os.register_at_fork(after_in_child=_become_main_thread)


def _before():
    # Block signals until the child has its own handlers; the inherited ones notify the runner.
    _masks.before = signal.pthread_sigmask(signal.SIG_BLOCK, _SIGNALS)


def _in_parent():
    signal.pthread_sigmask(signal.SIG_SETMASK, _masks.before)


def _in_child():
    _become_main_thread()
    _capture.release()
    _logging.release()
    global_variables._after_fork_in_child()
    for number in _SIGNALS:
        # Restore the handlers that Python knows (a plugin's, or an ignored signal). The runner's own handlers are unknown
        # to Python.
        signal.signal(number, signal.getsignal(number) or signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_SETMASK, _masks.before)


def _become_main_thread():
    """Make the only thread of the child a main thread, which waits for other threads at its end.

    Up to CPython 3.12 ``threading`` assumes that a thread that it did not start never ends, and
    fails.
    """
    if isinstance(threading.current_thread(), threading._DummyThread) and hasattr(threading.Thread, "_set_tstate_lock"):
        threading._main_thread = threading._MainThread()


def finish(error):
    """Wait for the threads of a child whose script returned or raised; return the exit code."""
    threading._shutdown()
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    if error is None:
        return 0
    code = error.code if isinstance(error, SystemExit) else 1
    if code is None or isinstance(code, int):
        return (code or 0) & 0xFF
    return 1
