"""What a forked child is: a process of its own that has nothing to do with the run.

Scripts fork by ``os.fork`` and ``multiprocessing``. The child prints and logs to the real streams, has its own copy of
the global variables, and dies of the signals that end a process; in the parent those are the runner's.
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
    """From now on every forked child is told what it is."""
    os.register_at_fork(before=_before, after_in_parent=_in_parent, after_in_child=_in_child)


def install_in_program():
    """Prepares forks of a program that runs machines itself. Its output and signals stay its own."""
    os.register_at_fork(after_in_child=_become_main_thread)


def _before():
    # Block signals until the child has its own handlers; otherwise they would reach the runner through its handlers.
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
    """Makes the only thread of the child a main thread, whose end waits for other threads.

    Up to CPython 3.12 ``threading`` takes a thread that it did not start for one without an end, and fails there.
    """
    if isinstance(threading.current_thread(), threading._DummyThread) and hasattr(threading.Thread, "_set_tstate_lock"):
        threading._main_thread = threading._MainThread()


def finish(error):
    """The end of a child whose script has returned or raised: waits for its threads, and returns the exit code."""
    threading._shutdown()
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    if error is None:
        return 0
    code = error.code if isinstance(error, SystemExit) else 1
    if code is None or isinstance(code, int):
        return (code or 0) & 0xFF
    return 1
