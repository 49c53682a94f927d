"""Sends the output of scripts to the running machine, with the state that printed it.

Lines of one write are one entry. Unfinished text is kept, per thread and stream, until its line
ends, a flush, or the end of the script. A progress bar is one entry.
"""

import io
import re
import sys
import threading

from rafcon._bridge import native

#: Maximum length of an entry; longer ones are truncated.
_ENTRY_MAX = 64 * 1024
_INFO, _WARNING = 20, 30
_TRACEBACK = "Traceback (most recent call last)"
#: A bar below another one: lines down, the bar, and as many lines up.
_BAR_BELOW = re.compile(r"\n+\r([^\n]*?)(?:\x1b\[A)+")

#: Unfinished text: (thread, stream) to (path of the state, text). Empty if there is nothing to flush.
pending = {}


def key_of(stream):
    """Key in ``pending`` of the calling thread."""
    return threading.get_ident(), stream


class Writer(io.TextIOBase):
    """Replacement for ``sys.stdout`` or ``sys.stderr``; a forked child writes to the original."""

    def __init__(self, stream, original):
        io.TextIOBase.__init__(self)
        self._stream = stream
        self._original = original
        self._forked = False
        self._buffer = _Bytes(self)

    @property
    def name(self):
        """Name of the original stream: ``<stdout>`` or ``<stderr>``."""
        return f"<{self._stream}>"

    @property
    def encoding(self):
        """Encoding of written text, always UTF-8."""
        return "utf-8"

    @property
    def errors(self):
        """Error handler for characters that UTF-8 cannot encode."""
        return "backslashreplace"

    @property
    def buffer(self):
        """Binary stream that decodes bytes and writes them as text."""
        return self._buffer

    @property
    def is_captured(self):
        """True if text is sent to the running machine; False in a forked child."""
        return not self._forked

    def writable(self):
        """Return True."""
        return True

    def fileno(self):
        """File descriptor of the original stream, for programs that a script starts."""
        return self._original.fileno()

    def isatty(self):
        """Return False: printed text becomes messages."""
        return False

    def write(self, text):
        """Send the text once its line ends; return the number of characters."""
        if not isinstance(text, str):
            raise TypeError(f"write() argument must be str, not {type(text).__name__}")
        if self._forked:
            return self._original.write(text)
        at = key_of(self._stream)
        path, waiting = pending.pop(at, (None, ""))
        if path is None:
            path = native.current_path()
        waiting += text
        if waiting.endswith("\n"):
            _send(path, self._stream, waiting[:-1])
            return len(text)
        waiting = _folded(waiting)
        while len(waiting) > _ENTRY_MAX:
            _emit(path, self._stream, waiting[:_ENTRY_MAX])
            waiting = waiting[_ENTRY_MAX:]
        if waiting:
            pending[at] = (path, waiting)
        return len(text)

    def flush(self):
        """Send the unfinished text of the calling thread, except for a progress bar."""
        if self._forked:
            self._original.flush()
            return
        at = key_of(self._stream)
        path, waiting = pending.pop(at, (None, ""))
        finished, newline, line = waiting.rpartition("\n")
        if "\r" not in line:
            finished, newline, line = waiting, waiting, ""
        if newline:
            _send(path, self._stream, finished)
        if line:
            pending[at] = (path, line)

    def released(self):
        """Write to the original from now on: the machine runs in another process."""
        self._forked = True


class _Bytes(io.RawIOBase):
    """Binary stream of a writer: decodes bytes to text."""

    def __init__(self, writer):
        io.RawIOBase.__init__(self)
        self._writer = writer

    def writable(self):
        return True

    def write(self, data):
        data = bytes(data)
        self._writer.write(data.decode("utf-8", "backslashreplace"))
        return len(data)

    def flush(self):
        self._writer.flush()

    def fileno(self):
        return self._writer.fileno()


def _folded(text):
    """Reduce each progress bar to its newest drawing; carriage returns mark an unfinished one."""
    if "\r" not in text:
        return text
    if "\x1b[A" in text:
        text = _BAR_BELOW.sub(r"\r\1", text)
    finished, newline, line = text.rpartition("\n")
    if "\r" in line:
        line = _newest(line) + "\r" if line.endswith("\r") else "\r" + _newest(line)
    return "\n".join(map(_newest, finished.split("\n"))) + newline + line


def _newest(line):
    """Last drawing of a progress bar, or the line itself."""
    if "\r" not in line:
        return line
    drawings = [drawing for drawing in line.split("\r") if drawing.strip()]
    return drawings[-1] if drawings else ""


def _send(path, stream, text):
    """Send text as one entry, or in pieces of whole lines if it is long."""
    text = "\n".join(map(_newest, _folded(text).split("\n")))
    while len(text) > _ENTRY_MAX:
        end = text.rfind("\n", 0, _ENTRY_MAX)
        piece, text = (text[:end], text[end + 1 :]) if end > 0 else (text[:_ENTRY_MAX], text[_ENTRY_MAX:])
        _emit(path, stream, piece)
    _emit(path, stream, text)


def _emit(path, stream, text):
    level = _WARNING if stream == "stderr" and _TRACEBACK in text else _INFO
    native.emit(path, stream, level, text.encode("utf-8", "backslashreplace").decode("utf-8"))


def flush_capture():
    """Send the unfinished text of the calling thread."""
    thread = threading.get_ident()
    for key in [key for key in list(pending) if key[0] == thread]:
        _flush(key)


def flush_all():
    """Send the unfinished text of every thread, at the end of the process."""
    for key in list(pending):
        _flush(key)


def _flush(key):
    path, text = pending.pop(key, (None, ""))
    if text:
        _send(path, key[1], text)


def install():
    """Replace ``sys.stdout`` and ``sys.stderr`` by writers."""
    sys.stdout = Writer("stdout", sys.stdout)
    sys.stderr = Writer("stderr", sys.stderr)


def release():
    """In a forked child: discard the parent's unfinished text, print to the original streams."""
    pending.clear()
    for writer in (sys.stdout, sys.stderr):
        if isinstance(writer, Writer):
            writer.released()
