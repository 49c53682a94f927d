"""Breakpoints of programs and scripts, which hold the run before a state."""

import itertools
import os
import threading
import weakref

from rafcon import _objects
from rafcon._bridge import native
from rafcon.utils.log import get_logger

logger = get_logger(__name__)

#: First id of these breakpoints; those of viewers are lower.
_FIRST_ID = 1 << 40


class BreakpointManager:
    """Breakpoints of this process, kept from run to run.

    A breakpoint belongs to the name of a state's folder. It applies wherever the state is used: in
    its library and in every machine that uses the library. It holds all branches;
    ``engine.start()`` resumes them.
    """

    def __init__(self):
        self._lock = threading.Lock()
        self._breakpoints = {}
        self._listeners = []
        self._ids = itertools.count(_FIRST_ID)
        # Path in the running machine to the id of its breakpoint.
        self._set = {}

    def add_breakpoint(self, state, display_name):
        """Set a breakpoint before a state, for this run and later ones.

        ``display_name`` is the name that is shown to people.
        """
        entry = {"enabled": True, "name": display_name, "display_path": state.file_system_path}
        self._change(lambda breakpoints: breakpoints.update({_key(state): entry}))

    def remove_breakpoint(self, state):
        """Remove the breakpoint of a state."""
        self.remove_breakpoint_by_id(_key(state))

    def remove_breakpoint_by_id(self, state_id):
        """Remove the breakpoint of a state, by the name of the state's folder."""
        self._change(lambda breakpoints: breakpoints.pop(state_id, None))

    def toggle_breakpoint(self, state_id):
        """Disable the breakpoint of a folder's name, or enable it again."""

        def toggle(breakpoints):
            if state_id in breakpoints:
                breakpoints[state_id]["enabled"] = not breakpoints[state_id]["enabled"]

        self._change(toggle)

    def clear_all(self):
        """Remove all breakpoints."""
        self._change(dict.clear)

    def enable_all(self):
        """Enable all breakpoints."""
        self._switch_all(True)

    def disable_all(self):
        """Disable all breakpoints, without removing them."""
        self._switch_all(False)

    def _switch_all(self, enabled):
        self._change(lambda breakpoints: [entry.update(enabled=enabled) for entry in breakpoints.values()])

    def get_all_breakpoints(self):
        """Breakpoints: name of the state's folder to ``enabled``, ``name`` and ``display_path``."""
        with self._lock:
            return {key: dict(entry) for key, entry in self._breakpoints.items()}

    def should_pause(self, state):
        """True if the state has an enabled breakpoint."""
        return self.get_all_breakpoints().get(_key(state), {}).get("enabled", False)

    def add_listener(self, callback):
        """Call a function without arguments after each change, while it (or its object) exists."""
        reference = weakref.WeakMethod(callback) if hasattr(callback, "__self__") else weakref.ref(callback)
        self._listeners.append(reference)

    def remove_listener(self, callback):
        """Remove a listener."""
        self._listeners = [ref for ref in self._listeners if not self.is_same_callback(ref, callback)]

    def is_same_callback(self, ref, callback):
        """True if a weak reference refers to a function."""
        return ref() == callback

    def _change(self, change):
        with self._lock:
            change(self._breakpoints)
            machine = _objects.machine_or_none()
            if machine is not None and machine.root_state.active:
                self._apply(machine)
        for found in [reference() for reference in self._listeners]:
            if found is not None:
                found()

    def _apply(self, machine):
        """Update the breakpoints of the running machine."""
        wanted = set(self._paths(machine))
        for path in [path for path in self._set if path not in wanted]:
            native.command("remove_breakpoint", None, self._set.pop(path))
        for path in sorted(wanted.difference(self._set)):
            self._set[path] = next(self._ids)
            native.command("set_breakpoint", path, self._set[path])

    def _paths(self, machine):
        enabled = {key for key, entry in self._breakpoints.items() if entry["enabled"]}
        if not enabled:
            return
        waiting = [machine.root_state]
        while waiting:
            state = waiting.pop()
            if _key(state) in enabled:
                yield state.get_path()
            waiting.extend(getattr(state, "states", {}).values())
            inner = getattr(state, "state_copy", None)
            if inner is not None:
                waiting.append(inner)

    def _launched(self, machine):
        """Breakpoints for the launch message of a run."""
        with self._lock:
            self._set = {path: next(self._ids) for path in self._paths(machine)}
            return [{"id": number, "path": path, "scope": "run"} for path, number in self._set.items()]


def _key(state):
    """Key of a state's breakpoint: the name of the state's folder, current or at the next save."""
    from rafcon.core.storage.storage import get_storage_id_for_state

    folder = state.file_system_path
    return get_storage_id_for_state(state) if folder is None else os.path.basename(os.path.normpath(folder))
