"""How long something took."""

import functools
import time

from rafcon.utils.log import get_logger


class Timer:
    """Context manager that logs how long its block took."""

    def __init__(self, logger=None, name="timer"):
        self._logger = logger or get_logger(__name__)
        self._name = name
        self._start_s = None

    def __enter__(self):
        self._start_s = time.perf_counter()
        return self

    def __exit__(self, *_exception):
        self._logger.info("%s: %.6f s", self._name, time.perf_counter() - self._start_s)


def measure_time(function):
    """Decorator: logs how long each call took."""

    @functools.wraps(function)
    def wrapper(*arguments, **named):
        with Timer(name=function.__qualname__):
            return function(*arguments, **named)

    return wrapper
