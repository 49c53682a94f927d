"""Handlers and filters for :mod:`logging`."""

import logging


class NoHigherLevelFilter(logging.Filter):
    """Filter that passes records below a level."""

    def __init__(self, level):
        logging.Filter.__init__(self)
        self.level = level

    def filter(self, record):
        """True if the record is below the level."""
        return record.levelno < self.level


class LoggingViewHandler(logging.Handler):
    """Handler that passes each record to the added views, for programs that display a log."""

    _views = {}

    def __init__(self):
        logging.Handler.__init__(self)

    def emit(self, record):
        """Call ``view.print_message(text, level)`` for each view."""
        try:
            message = self.format(record)
            for view in list(self._views.values()):
                view.print_message(message, record.levelno)
        except Exception:
            self.handleError(record)

    @classmethod
    def add_logging_view(cls, name, view):
        """Add a view with a name."""
        cls._views[name] = view

    @classmethod
    def remove_logging_view(cls, name):
        """Remove the view with a name."""
        cls._views.pop(name, None)
