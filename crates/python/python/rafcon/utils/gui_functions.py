"""Functions for scripts that may run with or without a desktop."""


def call_gui_callback(callback, *args, **kwargs):
    """Call a function directly, because there is no desktop thread to run it on."""
    return callback(*args, **kwargs)
