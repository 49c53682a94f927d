"""Decorators of functions."""

import functools
import threading


def avoid_parallel_execution(func):
    """Decorator: return None at once from calls made while the function runs on any thread."""
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
