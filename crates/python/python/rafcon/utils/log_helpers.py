"""Handlers and filters for :mod:`logging`."""

import logging


class NoHigherLevelFilter(logging.Filter):
    """Lets records pass that are below a level."""

    def __init__(self, level):
        logging.Filter.__init__(self)
        self.level = level

    def filter(self, record):
        """Whether a record passes."""
        return record.levelno < self.level


class LoggingViewHandler(logging.Handler):
    """Hands each record to the views that were added, for whoever shows a log in a window of their own."""

    _views = {}

    def __init__(self):
        logging.Handler.__init__(self)

    def emit(self, record):
        """Calls ``view.print_message(text, level)`` of each view."""
        try:
            message = self.format(record)
            for view in list(self._views.values()):
                view.print_message(message, record.levelno)
        except Exception:
            self.handleError(record)

    @classmethod
    def add_logging_view(cls, name, view):
        """Adds a view under a name."""
        cls._views[name] = view

    @classmethod
    def remove_logging_view(cls, name):
        """Takes the view of a name away."""
        cls._views.pop(name, None)
