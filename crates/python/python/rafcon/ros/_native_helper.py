"""Helper process ``rafcon-ros``: search, start, communication and end.

One thread reads from the helper and passes responses to waiting callers. Another thread runs the
callbacks in order, so that a callback may call the helper as well.
"""

import itertools
import os
import queue
import shutil
import socket
import subprocess
import sys
import tempfile
import threading
import weakref

from rafcon.ros import _native_frames
from rafcon.ros._backend import BackendLost, RosError
from rafcon.ros._native_callbacks import Callbacks

#: Path of the helper, if it is neither next to ``rafcon`` nor in PATH.
BINARY_VARIABLE = "RAFCON_ROS"
_NAME = "rafcon-ros.exe" if os.name == "nt" else "rafcon-ros"
#: Timeout (s) for its good-bye to peers; then it is killed.
_END_S = 1.7
#: Response timeout (s); only making a node takes a moment.
_ANSWER_S = 15.0
#: Maximum size (bytes) of the reported end of its output.
_LAST_WORDS = 2000

#: All running helpers, so that a forked child can release them.
_running = weakref.WeakSet()


def found():
    """Path of the helper's program; ``RosError`` if it is missing."""
    named = os.environ.get(BINARY_VARIABLE)
    if named:
        if os.path.isfile(named):
            return named
        raise RosError(f"{BINARY_VARIABLE} names {named}, which is no file")
    # The supervisor of a run passes the path of the extension, which is beside `rafcon`.
    near = (os.environ.get("RAFCON_EXTENSION_FILE"), shutil.which("rafcon"), sys.executable)
    for beside in filter(None, near):
        path = os.path.join(os.path.dirname(os.path.realpath(beside)), _NAME)
        if os.path.isfile(path):
            return path
    path = shutil.which(_NAME)
    if path is None:
        raise RosError(
            f"there is neither rclpy in {sys.executable} nor the program rafcon-ros. Install one of them: "
            f"`cargo xtask ros-helper` builds rafcon-ros and puts it beside rafcon; {BINARY_VARIABLE} can name it"
        )
    return path


class Helper:
    """Helper process. Its callback thread calls the first function with each event.

    The second function is called once at the end, with the reason.
    """

    def __init__(self, heard, ended):
        self._heard = heard
        self._ended = ended
        self._answers = {}
        self._numbers = itertools.count(1)
        self._lock = threading.Lock()
        self._sending = threading.Lock()
        self._closed = False
        self._lost = None
        self._callbacks = Callbacks()
        self._stderr = tempfile.TemporaryFile()
        path = found()
        own, other = socket.socketpair()
        try:
            # Start a new session: a keyboard interrupt is for the run only, and the helper ends with its socket.
            streams = {"stdin": other, "stdout": other, "stderr": self._stderr}
            self._process = subprocess.Popen([path, "serve"], start_new_session=True, **streams)
        except OSError as error:
            own.close()
            raise RosError(f"cannot start {path}: {error}") from error
        finally:
            other.close()
        self._socket = own
        _running.add(self)
        self._threads = [threading.Thread(target=each, daemon=True) for each in (self._read, self._call_back)]
        for each, name in zip(self._threads, ("ros", "ros callbacks")):
            each.name = name
            each.start()

    @property
    def pid(self):
        """Process id."""
        return self._process.pid

    def check(self):
        """Raise :class:`BackendLost` if the helper has ended."""
        if self._lost is not None or self._closed:
            raise BackendLost(f"the ROS node has ended: {self._lost or 'it was closed'}")

    def tell(self, what, **fields):
        """Send a command without a response."""
        self.check()
        try:
            frame = _native_frames.packed({"do": what, **fields})
        except (TypeError, ValueError) as error:
            raise RosError(f"this cannot be sent: {error}") from error
        try:
            with self._sending:
                self._socket.sendall(frame)
        except OSError as error:
            raise BackendLost(f"the ROS node has ended: {self._lost or error}") from error

    def ask(self, what, **fields):
        """Send a command and wait for its response."""
        number = next(self._numbers)
        answer = queue.SimpleQueue()
        with self._lock:
            self._answers[number] = answer
        try:
            self.check()
            self.tell(what, ask=number, **fields)
            found = answer.get(timeout=_ANSWER_S)
        except queue.Empty:
            raise BackendLost(f"rafcon-ros has not answered within {_ANSWER_S:g} s") from None
        finally:
            with self._lock:
                self._answers.pop(number, None)
        if found is None:
            raise BackendLost(f"the ROS node has ended: {self._lost}")
        if "error" in found:
            raise RosError(found["error"])
        return found["value"]

    def _read(self):
        with self._socket.makefile("rb", 1 << 18) as stream:
            try:
                while True:
                    event, size = _native_frames.read(stream)
                    if event is None:
                        break
                    if "answer" in event:
                        with self._lock:
                            waiting = self._answers.get(event["answer"])
                        if waiting is not None:
                            waiting.put(event)
                    else:
                        self._callbacks.put(event, size)
            except (OSError, ValueError):
                pass
        self._lost = self._why()
        with self._lock:
            for waiting in self._answers.values():
                waiting.put(None)
        self._callbacks.put(None)

    def _call_back(self):
        while True:
            event = self._callbacks.get()
            if event is None:
                break
            if not self._closed:
                self._heard(event)
        if not self._closed:
            self._closed = True
            self._ended(self._lost)
            self._release()

    def _why(self):
        try:
            code = self._process.wait(_END_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            code = self._process.wait()
        self._stderr.seek(0, os.SEEK_END)
        self._stderr.seek(max(0, self._stderr.tell() - _LAST_WORDS))
        words = self._stderr.read().decode(errors="replace").strip()
        how = f"by signal {-code}" if code < 0 else f"with code {code}"
        return f"rafcon-ros ended {how}" + (f": {words}" if words else "")

    def close(self):
        """End the process; return when it has ended."""
        if self._closed:
            return
        self._closed = True
        try:
            self._socket.shutdown(socket.SHUT_WR)
        except OSError:
            pass
        current = threading.current_thread()
        for each in self._threads:
            if each is not current:
                each.join(_END_S + 0.2)
        self._release()

    def _release(self):
        self._socket.close()
        self._stderr.close()


def _let_go():
    """In a forked child: close the socket, so that the parent's helper detects the parent's end."""
    for each in list(_running):
        each._closed = True
        each._lost = "this is a forked process"
        descriptor = each._socket.detach()
        if descriptor >= 0:
            os.close(descriptor)


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_let_go)
