"""What scripts log goes to the running machine, with the state that logged it."""

import logging
import os

from rafcon._bridge import native
from rafcon.utils.log import VERBOSE, get_logger


#: Name of the logger of a state to the path of the state: for what threads log that a script has started.
owners = {}


class Handler(logging.Handler):
    """Sends each record of the logger ``rafcon`` as one message."""

    def __init__(self):
        logging.Handler.__init__(self)
        self._forked = False

    def emit(self, record):
        """Sends the record, an exception's traceback after its text."""
        try:
            message = self.format(record)
            if self._forked:
                os.write(2, (message + "\n").encode("utf-8", "backslashreplace"))
                return
            path = native.current_path()
            if path < 0:
                path = owners.get(record.name, -1)
            native.emit(path, "logger", record.levelno, _utf8(message))
        except Exception:
            self.handleError(record)

    def released(self):
        """Writes to the standard error from now on: the machine does not live in this process."""
        self._forked = True


def release():
    """In a forked child: what is logged goes to the standard error."""
    for handler in get_logger("rafcon").handlers:
        if isinstance(handler, Handler):
            handler.released()


def _utf8(text):
    return text.encode("utf-8", "backslashreplace").decode("utf-8")


def install():
    """Sets up the logger ``rafcon``: every level down to VERBOSE, one handler. Python's warnings are logged too.

    ``RAFCON_LOGGING_CONF`` may name a JSON file for ``logging.config.dictConfig``: its levels, filters and files hold.
    Handlers that would print to the terminal make way for ours, or each line came twice.
    """
    logger = get_logger("rafcon")
    logger.setLevel(VERBOSE)
    problem = _configure(os.environ.get("RAFCON_LOGGING_CONF"))
    handler = Handler()
    _take_over(logger, handler)
    _take_over(logging.getLogger("py.warnings"), handler)
    logging.captureWarnings(True)
    if problem:
        logger.warning(problem)


def _take_over(logger, handler):
    logger.propagate = False
    for printing in [found for found in logger.handlers if type(found) is logging.StreamHandler]:
        logger.removeHandler(printing)
    logger.addHandler(handler)


def _configure(path):
    """Applies the user's configuration; returns what is wrong with it, if anything is."""
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
