"""Runs of a machine that a program has built, in the program's own process, one at a time.

The engine receives the machine from memory. A start writes no file, unless a journal is requested.
"""

import json
import logging
import os
import socket
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
#: Maximum number of names to try for the folder of a run.
_TRIES = 100


class Run:
    """One run. :meth:`begin` starts it and waits until it has begun.

    The ``engine`` is notified of each branch that is held, and of the end. ``wanted`` holds fields
    of the launch message. ``folder`` is the folder of the journal, or None for a run without a
    journal.
    """

    def __init__(self, machine, engine, wanted, inputs=None, folder=None):
        from rafcon.core.singleton import library_manager

        #: The folder (``str``) of the journal, or None.
        self.folder = folder
        self.machine = machine
        self._engine = engine
        self._error = None
        self._ending = None
        self._is_last = True
        self._is_sent = False
        self._begun = threading.Event()
        self._over = threading.Event()
        _objects.forget_machine()
        ours, theirs = socket.socketpair()
        document = None if "resume" in wanted else machine._document
        given = (theirs, document, library_manager._roots(), list((inputs or {}).items()))
        self._send(ours, library_manager, wanted)
        self._host = threading.Thread(target=self._serve, args=given, name="rafcon run")
        self._reader = threading.Thread(target=self._read, args=(ours,), name="rafcon run's log")

    def begin(self):
        """Start the machine and wait until it runs; ``RuntimeError`` if it cannot be run."""
        self._is_sent = True
        self._host.start()
        self._begun.wait()
        if self._error is not None:
            self.join()
            raise RuntimeError(f"the state machine cannot be run: {self._error}")

    def _send(self, ours, library_manager, wanted):
        launch = {
            "message": "launch",
            "machine": self.machine.file_system_path or "",
            "libraries": list(library_manager.library_root_paths.items()),
            "config": global_config._path,
            "breakpoints": self._breakpoints(),
            "run_folder": self.folder,
            "listen": self.folder is not None,
            **wanted,
        }
        for message in ({"protocol": native.PROTOCOL, "program": "python"}, launch):
            ours.sendall(json.dumps(message).encode() + b"\n")

    def _breakpoints(self):
        from rafcon.core.singleton import state_machine_execution_engine

        return state_machine_execution_engine.breakpoint_manager._launched(self.machine)

    def _serve(self, theirs, *given):
        self._reader.start()
        try:
            native.host(theirs.detach(), *given)
            self._ending = native.ending()
        except Exception as error:
            self._error = self._error or str(error)
        finally:
            # Read the last messages first; they decide if the run began or failed.
            self._reader.join()
            self._engine._ended(self)
            self._begun.set()
            self._over.set()

    def _read(self, ours):
        frames = native.RunMessages()
        with ours, ours.makefile("rb") as stream:
            self._hear(json.loads(stream.readline() or b"{}"))
            while (messages := frames.next(stream)) is not None:
                for message in messages:
                    self._hear(json.loads(message))

    def _hear(self, message):
        kind = message.get("message")
        if kind == "load_failed":
            self._error = message["reason"]
        elif kind == "loaded":
            told = self.machine.root_state._problems_told
            for problem in message["problems"]:
                if problem not in told:
                    logger.warning(problem)
            self._begun.set()
        elif kind == "event":
            self._happened(message["event"])

    def _happened(self, event):
        if event["type"] == "held":
            self._engine._held(event["by"]["type"])
        elif event["type"] == "log" and event["stream"] == "engine":
            logger.log(_LEVELS.get(event["level"], logging.INFO), event["message"])

    def join(self, timeout=None):
        """Wait for the end; False if the timeout (s) expired."""
        if not self._is_sent:
            return True
        if not self._over.wait(timeout):
            return False
        self._host.join()
        return True

    def is_over(self):
        """True if the run has ended or was not started."""
        return not self._is_sent or self._over.is_set()

    def retire(self):
        """Mark the run as replaced by a newer one: only its end stays known."""
        self._is_last = False

    def live(self, state):
        """Data and status of a state of the machine: current, or those of the end of the run."""
        live = {"active": False, "phase": "inactive", "final_outcome": None, "run_count": 0, "entered_ns": 0}
        live.update(input_data={}, output_data={}, scoped_data={})
        if self._is_last:
            found = _objects.machine().get_state_by_path(state.get_path(), as_check=True)
            live.update(found._live() if found is not None else {})
        if state._above is None and self._ending is not None:
            live.update(self._ending)
        return live


def run_folder(machine, journal):
    """Create the folder of a run that keeps a journal.

    Its parent is the folder ``journal``, or the folder of ``rafcon run`` if ``journal`` is True.
    Old runs in the parent are deleted by the rules of ``rafcon run``.
    """
    runs = os.path.abspath(_usual_runs() if journal is True else os.fspath(journal))
    os.makedirs(runs, exist_ok=True)
    try:
        native.give_up_old_runs(runs)
    except OSError as error:
        logger.warning("old runs stay: %s", error)
    name = os.path.basename(machine.file_system_path or "") or machine.root_state.name
    for _ in range(_TRIES):
        folder = os.path.join(runs, native.run_id(name, int.from_bytes(os.urandom(2), "big")))
        try:
            os.mkdir(folder, 0o700)
        except FileExistsError:
            continue
        return folder
    raise FileExistsError(f"cannot find a free name for a run in {runs}")


def _usual_runs():
    if os.environ.get("RAFCON_RUNS"):
        return os.environ["RAFCON_RUNS"]
    state = os.environ.get("XDG_STATE_HOME") or os.path.join(os.path.expanduser("~"), ".local", "state")
    return os.path.join(state, "rafcon", "runs")
