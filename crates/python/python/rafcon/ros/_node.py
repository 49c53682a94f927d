"""Node of this process: created on first use of ROS, closed at the end of the run."""

import atexit
import importlib.util
import os
import sys
import threading
import time

from rafcon.ros import _waits
from rafcon.ros._backend import BackendLost, RosError, Settings
from rafcon.ros._types import Types, absolute
from rafcon.utils.log import get_logger

logger = get_logger("ros")

#: Forces a back end: ``rclpy`` or ``native``.
BACKEND_VARIABLE = "RAFCON_ROS_BACKEND"
#: Set to 1: ``now`` and transforms follow the topic ``/clock``.
SIM_TIME_VARIABLE = "RAFCON_ROS_SIM_TIME"
#: Folders of interface files, separated by colons.
TYPES_VARIABLE = "RAFCON_ROS_TYPES"

#: Timeout (s) for finding a server.
FIND_S = 1.8
#: Time (s) after which a new node knows all others: DDS announces each every three seconds.
_HEARD_ALL_S = 3.5
_LEVELS = ("debug", "info", "warning", "error")


class Node:
    """Back end with all its shared objects, created by :func:`node`."""

    def __init__(self, backend, settings, use_sim_time):
        self.backend = backend
        self.settings = settings
        self.use_sim_time = use_sim_time
        self.types = Types(backend.describe)
        self.logger = logger
        self._began_s = time.monotonic()
        #: Reason of the node's end, or None.
        self.ended = None
        self._lock = threading.RLock()
        self._shared = {}
        self._shared_locks = {}
        #: Called before the back end closes; keyed by a name for what is released.
        self.closers = {}

    def lost(self, why):
        """Handle an unexpected end of the back end."""
        logger.error("ROS is gone: %s; the next call of rafcon.ros makes a new node", why)
        self.ended = why
        _forget(self)
        _waits.ring_all()

    def changed(self):
        """Handle possible changes of nodes, endpoints, services or actions."""
        _waits.ring_all()

    def say(self, level, text):
        """Log a line of the back end."""
        getattr(logger, level if level in _LEVELS else "info")("%s", text)

    def absolute(self, name):
        """Convert the name of a topic, service, action or node to an absolute one."""
        return absolute(name, self.settings.namespace)

    def shared(self, key, make):
        """Object shared by all calls with this key; the first call creates it with ``make()``.

        Callers with other keys do not wait for it.
        """
        with self._lock:
            self.check()
            if key in self._shared:
                return self._shared[key]
            lock = self._shared_locks.setdefault(key, threading.Lock())
        with lock:
            with self._lock:
                if key in self._shared:
                    return self._shared[key]
            made = make()
            with self._lock:
                self._shared[key] = made
            return made

    def find_s(self, seconds, default=FIND_S):
        """Timeout (s) for finding others, extended for a new node.

        A new node discovers some nodes only by their next announcement, up to 3 s later. A timeout
        below the default is not extended.
        """
        if seconds is None or seconds < default:
            return seconds
        return max(seconds, _HEARD_ALL_S - (time.monotonic() - self._began_s))

    def check(self):
        """Raise :class:`BackendLost` if the node has ended."""
        if self.ended is not None:
            raise BackendLost(f"the ROS node has ended: {self.ended}")

    def close(self, why):
        """Close the node."""
        with self._lock:
            if self.ended is not None:
                return
            self.ended = why
            closers = list(self.closers.values())
        _waits.ring_all()
        for closer in closers:
            try:
                closer()
            except RosError as error:
                logger.debug("%s", error)
        self.backend.close()


_lock = threading.Lock()
_node = None
_wanted = {}


def configure(name=None, namespace=None, domain=None, use_sim_time=None, backend=None, types=None):
    """Configure the node, before anything else of :mod:`rafcon.ros` is used."""
    wanted = {"name": name, "namespace": namespace, "domain": domain, "use_sim_time": use_sim_time, "backend": backend}
    wanted["types"] = None if types is None else tuple(os.fspath(each) for each in ([types] if isinstance(types, str) else types))
    wanted = {key: value for key, value in wanted.items() if value is not None}
    with _lock:
        differs = [key for key, value in wanted.items() if _wanted.get(key) != value]
        if _node is not None and differs:
            raise RosError(f"the ROS node is there already, so {', '.join(differs)} cannot change; call configure first, or close() before")
        _wanted.update(wanted)


def node():
    """Return the node; create it if there is none."""
    global _node
    found = _node
    if found is not None and found.pid == os.getpid():
        return found
    with _lock:
        if _node is None:
            _node = _made()
        elif _node.pid != os.getpid():
            raise RosError("this is a forked process; only the process that made the ROS node can use it")
        return _node


def close():
    """Close the node if there is one: cancel active goals, release publishers and subscriptions."""
    global _node
    with _lock:
        found, _node = _node, None
    if found is not None and found.pid == os.getpid():
        found.close("it was closed")


def _forget(ended):
    global _node
    with _lock:
        if _node is ended:
            _node = None


def _made():
    # Distinct names separate two runs; ROS only warns of duplicate names, and graphs become unreadable.
    namespace = _wanted.get("namespace", "/")
    settings = Settings(
        name=_wanted.get("name", f"rafcon_{os.getpid()}"),
        namespace="/" if namespace.strip("/") == "" else absolute("/" + namespace.strip("/")),
        domain=_wanted.get("domain"),
        type_folders=_wanted.get("types", ()) + tuple(filter(None, os.environ.get(TYPES_VARIABLE, "").split(os.pathsep))),
    )
    use_sim_time = _wanted.get("use_sim_time", os.environ.get(SIM_TIME_VARIABLE, "") not in ("", "0"))
    backend = _backend(_wanted.get("backend") or os.environ.get(BACKEND_VARIABLE))
    made = Node(backend, settings, use_sim_time)
    made.pid = os.getpid()
    backend.start(settings, made)
    logger.debug("ROS node %s/%s by %s", settings.namespace.rstrip("/"), settings.name, backend.name)
    return made


def _backend(name):
    name = name or ("rclpy" if importlib.util.find_spec("rclpy") else "native")
    if name == "rclpy":
        try:
            from rafcon.ros._rclpy import RclpyBackend
        except ImportError as error:
            raise RosError(
                f"the back end rclpy cannot be used by {sys.executable}: {error}; source a ROS 2 workspace before the start, or "
                f"set {BACKEND_VARIABLE}=native"
            ) from error
        return RclpyBackend()
    if name == "native":
        try:
            from rafcon.ros._native import NativeBackend
        except ImportError as error:
            raise RosError(f"there is neither rclpy in {sys.executable} nor the native back end: {error}") from error
        return NativeBackend()
    raise RosError(f"{name!r} is no back end of rafcon.ros; write rclpy or native")


def types_for(name):
    """Types for creating messages of a type."""
    types = node().types
    types.require(name) if "/msg/" in name else types.get(name)
    return types


atexit.register(close)
