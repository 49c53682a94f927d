"""What scripts print goes to the running machine, line by line, with the state that printed it.

Lines that are not finished wait, for each thread and stream apart, until their end or the end of the script.
"""

import io
import sys
import threading

from rafcon._bridge import native

#: A line longer than this is cut, so that one message stays small.
_LINE_MAX = 64 * 1024
_LEVELS = {"stdout": 20, "stderr": 40}

#: Unfinished lines: (thread, stream) to (path of the state, text). Empty if there is nothing to flush.
pending = {}


class Writer(io.TextIOBase):
    """Stands in for ``sys.stdout`` or ``sys.stderr``; in a forked child it is the original again."""

    def __init__(self, stream, original):
        io.TextIOBase.__init__(self)
        self._stream = stream
        self._original = original
        self._forked = False
        self._buffer = _Bytes(self)

    @property
    def name(self):
        """As of the original: ``<stdout>`` or ``<stderr>``."""
        return f"<{self._stream}>"

    @property
    def encoding(self):
        """Always UTF-8."""
        return "utf-8"

    @property
    def errors(self):
        """How what UTF-8 cannot carry is written."""
        return "backslashreplace"

    @property
    def buffer(self):
        """Takes bytes."""
        return self._buffer

    def writable(self):
        """Always."""
        return True

    def fileno(self):
        """The process's own descriptor, for programs that a script starts."""
        return self._original.fileno()

    def isatty(self):
        """Never: what is printed becomes messages."""
        return False

    def write(self, text):
        """Sends the lines that are finished; returns the number of characters."""
        if not isinstance(text, str):
            raise TypeError(f"write() argument must be str, not {type(text).__name__}")
        if self._forked:
            return self._original.write(text)
        key = (threading.get_ident(), self._stream)
        path, waiting = pending.pop(key, (None, ""))
        if path is None:
            path = native.current_path()
        rest = _send_lines(path, self._stream, waiting + text)
        if rest:
            pending[key] = (path, rest)
        return len(text)

    def flush(self):
        """Nothing to do: an unfinished line waits for its end. In a forked child as usual."""
        if self._forked:
            self._original.flush()

    def released(self):
        """Writes to the original from now on: the machine does not live in this process."""
        self._forked = True


class _Bytes(io.RawIOBase):
    """``sys.stdout.buffer``: bytes become text."""

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


def _send_lines(path, stream, text):
    """Sends every finished line of the text and returns what is left."""
    start = 0
    end = text.find("\n")
    while end >= 0:
        _send_line(path, stream, text[start:end])
        start = end + 1
        end = text.find("\n", start)
    while len(text) - start > _LINE_MAX:
        _send(path, stream, text[start : start + _LINE_MAX])
        start += _LINE_MAX
    return text[start:]


def _send_line(path, stream, line):
    line = line.rstrip("\r")
    for start in range(0, max(len(line), 1), _LINE_MAX):
        _send(path, stream, line[start : start + _LINE_MAX])


def _send(path, stream, line):
    native.emit(path, stream, _LEVELS[stream], line.encode("utf-8", "backslashreplace").decode("utf-8"))


def flush_capture():
    """Sends the unfinished lines of the calling thread."""
    thread = threading.get_ident()
    for key in [key for key in list(pending) if key[0] == thread]:
        _flush(key)


def flush_all():
    """Sends the unfinished lines of every thread; for the end of the process."""
    for key in list(pending):
        _flush(key)


def _flush(key):
    path, text = pending.pop(key, (None, ""))
    if text:
        _send_line(path, key[1], text)


def install():
    """Puts the writers in place of ``sys.stdout`` and ``sys.stderr``."""
    sys.stdout = Writer("stdout", sys.stdout)
    sys.stderr = Writer("stderr", sys.stderr)


def release():
    """In a forked child: forgets the parent's unfinished lines, and prints to the real streams."""
    pending.clear()
    for writer in (sys.stdout, sys.stderr):
        if isinstance(writer, Writer):
            writer.released()
