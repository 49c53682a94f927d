"""Sends records of Python's ``logging`` to the running machine, with level, name of the logger, and state.

Each record is sent once: by the logger ``rafcon``, by a handler that prints to the terminal, or by the root handler.
"""

import functools
import logging
import os

from rafcon._bridge import native
from rafcon._capture import Writer
from rafcon.utils.log import VERBOSE, get_logger


#: Name of a state's logger to the state's path, for log lines of threads that a script has started.
owners = {}


class Handler(logging.Handler):
    """Handler that sends each record as one message."""

    def __init__(self):
        logging.Handler.__init__(self)
        self._forked = False

    def emit(self, record):
        """Send the record, with the traceback of an exception after its text."""
        try:
            message = self.format(record)
            if self._forked:
                os.write(2, (message + "\n").encode("utf-8", "backslashreplace"))
            elif not getattr(record, "_is_sent", False):
                record._is_sent = True
                _send(record, message)
        except Exception:
            self.handleError(record)

    def released(self):
        """Write to standard error from now on: the machine runs in another process."""
        self._forked = True


class _RootHandler(Handler):
    """Handler that sends records of all loggers, unless a handler that prints is installed."""

    def emit(self, record):
        if not any(map(_prints, logging.root.handlers)):
            Handler.emit(self, record)


def _send(record, message):
    path = native.current_path()
    if path < 0:
        path = owners.get(record.name, -1)
    if not _is_own(record.name):
        message = f"{record.name}: {message}"
    native.emit(path, "logger", record.levelno, _utf8(message))


def _is_own(name):
    return name in ("root", "rafcon", "py.warnings") or name.startswith("rafcon.")


def _prints(handler):
    """True if a handler writes to the captured ``sys.stdout`` or ``sys.stderr``."""
    return isinstance(handler, logging.StreamHandler) and isinstance(handler.stream, Writer)


_handler = Handler()
_emit_to_stream = logging.StreamHandler.emit
_basic_config = logging.basicConfig


def _emit(handler, record):
    """``StreamHandler.emit`` that sends records for the terminal to the machine as records."""
    if _prints(handler) and handler.stream.is_captured:
        _handler.emit(record)
    else:
        _emit_to_stream(handler, record)


@functools.wraps(_basic_config)
def _configure_basically(**options):
    """``logging.basicConfig``, which only affects a root logger with no handlers but ours."""
    root = logging.root
    ours = [handler for handler in root.handlers if isinstance(handler, _RootHandler)]
    for handler in ours:
        root.removeHandler(handler)
    try:
        _basic_config(**options)
    finally:
        for handler in ours:
            root.addHandler(handler)


def release():
    """In a forked child: write log records to standard error."""
    for handler in [*get_logger("rafcon").handlers, *logging.root.handlers]:
        if isinstance(handler, Handler):
            handler.released()


def _utf8(text):
    return text.encode("utf-8", "backslashreplace").decode("utf-8")


def install():
    """Set up the loggers ``rafcon`` (from level VERBOSE), root (from INFO) and Python's warnings.

    ``RAFCON_LOGGING_CONF`` may name a JSON file for ``logging.config.dictConfig``. Its levels,
    filters and files apply. Handlers that print to the terminal are replaced by ours, so that no
    line is logged twice.
    """
    logger = get_logger("rafcon")
    logger.setLevel(VERBOSE)
    logging.root.setLevel(logging.INFO)
    problem = _configure(os.environ.get("RAFCON_LOGGING_CONF"))
    handler = Handler()
    _take_over(logger, handler)
    _take_over(logging.getLogger("py.warnings"), handler)
    logging.captureWarnings(True)
    if not any(isinstance(handler, _RootHandler) for handler in logging.root.handlers):
        logging.root.addHandler(_RootHandler())
    logging.StreamHandler.emit = _emit
    logging.basicConfig = _configure_basically
    if problem:
        logger.warning(problem)


def _take_over(logger, handler):
    logger.propagate = False
    for printing in [found for found in logger.handlers if type(found) is logging.StreamHandler]:
        logger.removeHandler(printing)
    logger.addHandler(handler)


def _configure(path):
    """Apply the user's configuration; return a description of its error, or None."""
    if not path:
        return None
    import json
    import logging.config  # as late as this, for it takes long to load and is rarely wanted

    try:
        with open(path, encoding="utf-8") as file:
            logging.config.dictConfig(json.load(file))
    except Exception as error:
        return f"RAFCON_LOGGING_CONF: {path} is left out: {error}"
    return None
