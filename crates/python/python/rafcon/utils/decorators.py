"""Decorators of functions."""

import functools
import threading


def avoid_parallel_execution(func):
    """The function is not called while it runs on another thread: that call returns None at once."""
    runs = threading.Lock()

    @functools.wraps(func)
    def wrapper(*args, **kwargs):
        if not runs.acquire(blocking=False):
            return None
        try:
            return func(*args, **kwargs)
        finally:
            runs.release()

    return wrapper
