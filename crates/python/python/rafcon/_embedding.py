"""Runs of a machine that a program has built, in the program's own process: one at a time.

The engine reads the machine from its folder, or from a copy if it has changed since it was saved or loaded.
"""

import json
import logging
import socket
import tempfile
import threading

from rafcon import _objects
from rafcon._bridge import native
from rafcon.core.config import global_config
from rafcon.utils.log import VERBOSE, get_logger

logger = get_logger("rafcon.engine")
_LEVELS = {
    "error": logging.ERROR,
    "warning": logging.WARNING,
    "info": logging.INFO,
    "debug": logging.DEBUG,
    "verbose": VERBOSE,
}


class Run:
    """One run. Making it sends it off; :meth:`begin` waits until it has begun."""

    def __init__(self, machine, start_state_path=None, hold=False):
        self._machine = machine
        self._error = None
        self._ending = None
        self._is_last = True
        self._begun = threading.Event()
        _objects.forget_machine()
        self._copy = None if _is_saved(machine) else tempfile.TemporaryDirectory(prefix="rafcon-")
        ours, theirs = socket.socketpair()
        self._send(ours, {"start_from": start_state_path, "hold": hold})
        self._host = threading.Thread(target=self._serve, args=(theirs.detach(),), name="rafcon run")
        self._reader = threading.Thread(target=self._read, args=(ours,), name="rafcon run's log")
        self._reader.start()
        self._host.start()

    def begin(self):
        """Waits until the machine runs; ``RuntimeError`` if it cannot."""
        self._begun.wait()
        if self._error is not None:
            self.join()
            raise RuntimeError(f"the state machine cannot be run: {self._error}")

    def _send(self, ours, begin):
        if self._copy is not None:
            native.save_document(self._machine._document, self._copy.name, (True, None), (True, False))
        from rafcon.core.singleton import library_manager

        launch = {
            "message": "launch",
            "machine": self._machine.file_system_path if self._copy is None else self._copy.name,
            "libraries": list(library_manager.library_root_paths.items()),
            "config": global_config._path,
            "breakpoints": self._breakpoints(),
            **begin,
        }
        for message in ({"protocol": native.PROTOCOL, "program": "python"}, launch):
            ours.sendall(json.dumps(message).encode() + b"\n")

    def _breakpoints(self):
        from rafcon.core.singleton import state_machine_execution_engine

        return state_machine_execution_engine.breakpoint_manager._launched(self._machine)

    def _serve(self, theirs):
        try:
            native.host(theirs)
            self._ending = native.ending()
        except Exception as error:
            self._error = self._error or str(error)
        finally:
            # What it said last is heard before it counts as begun or failed.
            self._reader.join()
            if self._copy is not None:
                self._copy.cleanup()
            self._begun.set()

    def _read(self, ours):
        with ours, ours.makefile("rb") as lines:
            for line in lines:
                self._hear(json.loads(line))

    def _hear(self, message):
        kind = message.get("message")
        if kind == "load_failed":
            self._error = message["reason"]
        elif kind == "loaded":
            for problem in message["problems"]:
                logger.warning(problem)
            self._begun.set()
        elif kind == "event" and message["event"]["type"] == "log" and message["event"]["stream"] == "engine":
            logger.log(_LEVELS.get(message["event"]["level"], logging.INFO), message["event"]["message"])

    def join(self, timeout=None):
        """Waits for the end; False if the time (s) ran out."""
        self._host.join(timeout)
        if self._host.is_alive():
            return False
        self._reader.join()
        return True

    def is_over(self):
        """Whether it has ended."""
        return not self._host.is_alive()

    def retire(self):
        """Another run follows in this process: from now on only the end of this one is known."""
        self._is_last = False

    def live(self, state):
        """What a state of the machine holds and does now, or did last."""
        live = {"active": False, "phase": "inactive", "final_outcome": None, "run_count": 0}
        live.update(input_data={}, output_data={}, scoped_data={})
        if self._is_last:
            found = _objects.machine().get_state_by_path(state.get_path(), as_check=True)
            live.update(found._live() if found is not None else {})
        if state._above is None and self._ending is not None:
            live.update(self._ending)
        return live


def _is_saved(machine):
    return machine.file_system_path is not None and not machine.marked_dirty
