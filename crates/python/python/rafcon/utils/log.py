"""Loggers of a machine, below the logger ``rafcon``, with a level VERBOSE below DEBUG."""

import functools
import logging
import warnings

#: A level below ``logging.DEBUG``, for ``logger.verbose(…)``.
VERBOSE = 5


class RAFCONDeprecationWarning(DeprecationWarning):
    """A function still works and will be removed. Each warning is shown once."""


def _verbose(self, message, *arguments, **named):
    """Log at level VERBOSE."""
    if self.isEnabledFor(VERBOSE):
        self._log(VERBOSE, message, arguments, **named)


warnings.filterwarnings("once", category=RAFCONDeprecationWarning)
logging.addLevelName(VERBOSE, "VERBOSE")
logging.VERBOSE = VERBOSE
logging.Logger.verbose = _verbose


def get_logger(name):
    """Logger ``rafcon.<name>``; a name that begins with ``rafcon`` is used unchanged."""
    if name == "rafcon" or name.startswith("rafcon."):
        return logging.getLogger(name)
    return logging.getLogger("rafcon." + name)


def log_exceptions(logger=None):
    """Decorator: log an exception of the function, and raise it again."""

    def decorate(function):
        @functools.wraps(function)
        def wrapper(*arguments, **named):
            try:
                return function(*arguments, **named)
            except Exception:
                (logger or get_logger(function.__module__)).exception("%s failed", function.__name__)
                raise

        return wrapper

    return decorate
