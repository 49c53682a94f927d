"""Measurement of durations."""

import functools
import time

from rafcon.utils.log import get_logger


class Timer:
    """Timer that logs a duration, of a block (``with Timer(logger, name):``) or until ``stop``."""

    def __init__(self, logger, name="", continues=True):
        """With ``continues``, add up durations; without it, each start resets the timer."""
        self._logger = logger
        self._name = name
        self._continues = continues
        self._begun_s = None
        self._duration_s = 0.0
        #: Number of starts.
        self.count = 0

    def start(self):
        """Start the timer; return the number of starts."""
        if not self._continues:
            self._duration_s = 0.0
        self._begun_s = time.perf_counter()
        self.count += 1
        return self.count

    def stop(self, key=""):
        """Stop the timer and log the duration; ``key`` is appended to the name."""
        self._duration_s, self._begun_s = self.duration, None
        name = " ".join(filter(None, (self._name, str(key)))) or "the block"
        self._logger.info("%s took %.6f s", name, self._duration_s)

    def reset(self):
        """Reset the duration and the number of starts."""
        self._begun_s, self._duration_s, self.count = None, 0.0, 0

    @property
    def duration(self):
        """Duration (s) measured until now."""
        running_s = 0.0 if self._begun_s is None else time.perf_counter() - self._begun_s
        return self._duration_s + running_s

    def __enter__(self):
        self.start()
        return self

    def __exit__(self, *_exception):
        self.stop()


def measure_time(function):
    """Decorator: log the duration of each call."""

    @functools.wraps(function)
    def wrapper(*arguments, **named):
        with Timer(get_logger(function.__module__), function.__qualname__):
            return function(*arguments, **named)

    return wrapper
