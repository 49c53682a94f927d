"""Functions for scripts that may run with or without a desktop."""


def call_gui_callback(callback, *args, **kwargs):
    """Calls a function that wants the thread of the desktop; here there is none, so it is called directly."""
    return callback(*args, **kwargs)
