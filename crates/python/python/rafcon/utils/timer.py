"""How long something took."""

import functools
import time

from rafcon.utils.log import get_logger


class Timer:
    """Context manager that logs how long its block took."""

    def __init__(self, logger, name="", continues=True):
        """``continues`` is accepted for old scripts; each block is measured on its own."""
        self._logger = logger
        self._name = name
        self._start_s = None

    def __enter__(self):
        self._start_s = time.perf_counter()
        return self

    def __exit__(self, *_exception):
        self._logger.info("%s took %.6f s", self._name or "the block", time.perf_counter() - self._start_s)


def measure_time(function):
    """Decorator: logs how long each call took."""

    @functools.wraps(function)
    def wrapper(*arguments, **named):
        with Timer(get_logger(function.__module__), function.__qualname__):
            return function(*arguments, **named)

    return wrapper
