"""Registration of script threads in Python's ``threading``."""

import threading


def adopt():
    """Make the calling thread non-daemonic, so that threads that its scripts start outlive the run.

    ``threading`` takes a thread that it did not start for a daemon, and makes all threads that it
    starts daemons too.
    """
    threading.current_thread()._daemonic = False
