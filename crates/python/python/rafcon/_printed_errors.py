"""Writes each traceback that Python prints in one piece, so that it is one log entry."""

import functools
import io
import sys
import threading
import traceback

from rafcon._capture import Writer

#: Position of ``file`` among the arguments of ``traceback.print_exception``.
_FILE = 4
_print_exception = traceback.print_exception


@functools.wraps(_print_exception)
def _print_at_once(*arguments, **named):
    arguments = list(arguments)
    file = arguments[_FILE] if len(arguments) > _FILE else named.get("file")
    file = sys.stderr if file is None else file
    if not isinstance(file, Writer):
        return _print_exception(*arguments, **named)
    whole = io.StringIO()
    if len(arguments) > _FILE:
        arguments[_FILE] = whole
    else:
        named["file"] = whole
    _print_exception(*arguments, **named)
    _write("", whole.getvalue(), file)


def _of_thread(caught):
    """Hook for ``threading.excepthook``."""
    if caught.exc_type is SystemExit:
        return
    name = caught.thread.name if caught.thread is not None else threading.get_ident()
    _write(f"Exception in thread {name}:\n", _text(caught))


def _ignored(caught):
    """Hook for ``sys.unraisablehook``."""
    try:
        about = repr(caught.object)
    except Exception:
        about = object.__repr__(caught.object)
    _write(f"{caught.err_msg or 'Exception ignored in'}: {about}\n", _text(caught))


def _uncaught(kind, error, trace):
    """Hook for ``sys.excepthook``."""
    _write("", "".join(traceback.format_exception(kind, error, trace)))


def _text(caught):
    return "".join(traceback.format_exception(caught.exc_type, caught.exc_value, caught.exc_traceback))


def _write(head, text, file=None):
    file = file or sys.stderr
    if file is not None:
        file.write(head + text)
        file.flush()


def install():
    """Replace the functions with which Python prints tracebacks."""
    traceback.print_exception = _print_at_once
    threading.excepthook = _of_thread
    sys.unraisablehook = _ignored
    sys.excepthook = _uncaught
