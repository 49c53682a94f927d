"""The threads that run scripts, as Python's ``threading`` sees them."""

import threading


def adopt():
    """The calling thread runs scripts from now on: threads that they start outlive the run, as those of any program do.

    ``threading`` takes a thread that it did not start for a daemon, and would make daemons of all that it starts.
    """
    threading.current_thread()._daemonic = False
