"""State machines: the one that runs, and those that are being built or were loaded."""

import datetime
import threading
from contextlib import contextmanager
from copy import copy

from rafcon import _ids, _objects
from rafcon.core.custom_exceptions import MachineChangeNotSupported
from rafcon.core.execution.execution_history import ExecutionHistory
from rafcon.core.states.state import State
from rafcon.utils.log import get_logger

logger = get_logger(__name__)


class StateMachine:
    """A state machine; ``state.get_state_machine()`` gives the one that a state belongs to."""

    def __init__(self, root_state=None, version=None, creation_time=None, state_machine_id=None):
        self._init(_ids.machine_id() if state_machine_id is None else state_machine_id)
        self._version = version
        self._creation_time = creation_time or datetime.datetime.now(datetime.timezone.utc).strftime(
            "%Y-%m-%d %H:%M:%S"
        )
        self._root = None
        if root_state is not None:
            self.root_state = root_state

    def _init(self, state_machine_id):
        self._state_machine_id = state_machine_id
        self._facts = None
        self._marked_dirty = True
        self._modification_lock = threading.RLock()

    def _bind(self, facts):
        """It is the machine that runs."""
        self._init(1)
        self._facts = facts
        self._marked_dirty = False

    @classmethod
    def _loaded(cls, document, state_machine_id=None):
        """A machine that was read from files."""
        creation_time, version, _folder = document.header()
        machine = cls(None, version, creation_time, state_machine_id)
        root = _objects.blank_state(document.fact(document.root_id(), "kind"))
        root._settle_alone(document, document.root_id())
        machine.root_state = root
        machine._marked_dirty = False
        return machine

    @property
    def state_machine_id(self):
        """The id (``int``) in this process."""
        return self._state_machine_id

    @property
    def root_state(self):
        """The root state. One that stands elsewhere moves; where it stood, a copy stays behind."""
        return self._root if self._facts is None else _objects.state(self._facts["root"])

    @root_state.setter
    def root_state(self, root_state):
        if not isinstance(root_state, State):
            raise AttributeError(f"the root state must be a state, not {type(root_state).__name__}")
        if self._facts is not None:
            raise MachineChangeNotSupported("StateMachine.root_state = …")
        if root_state is self._root:
            return
        root_state._take_over()
        if self._root is not None:
            self._root._home.owner = None
        self._root = root_state
        root_state._home.owner = self
        self._marked_dirty = True

    def change_root_state_type(self, new_state_class):
        """Makes the root one of another class and returns the new object for it."""
        root = self.root_state
        root._change("state.kind", new_state_class._kind)
        if self._facts is None:
            self._root = root._home.replaced(None, root)
        return self.root_state

    @property
    def _document(self):
        """The machine as the compiled module has it, with everything that users changed."""
        if self._root is None:
            raise AttributeError("the state machine has no root state yet")
        home = self._root._home
        home.store_notes()
        home.document.set_header(self._creation_time, self._version)
        return home.document

    @property
    def file_system_path(self):
        """The folder (``str``) of the state machine, or None."""
        if self._facts is not None:
            return self._facts["file_system_path"]
        return None if self._root is None else self._root._home.document.header()[2]

    @property
    def version(self):
        """The version that the author gave it, or None."""
        return self._version if self._facts is None else self._facts["version"]

    @version.setter
    def version(self, version):
        if self._facts is not None:
            raise MachineChangeNotSupported("StateMachine.version = …")
        self._version = version
        self._marked_dirty = True

    @property
    def creation_time(self):
        """When it was made, as text in UTC."""
        return self._creation_time if self._facts is None else self._facts["creation_time"]

    @property
    def marked_dirty(self):
        """Whether it has changes that are not saved."""
        return self._marked_dirty

    @marked_dirty.setter
    def marked_dirty(self, marked_dirty):
        self._marked_dirty = bool(marked_dirty)

    @property
    def execution_histories(self):
        """One history for each run of this process."""
        return [ExecutionHistory(self.root_state)]

    def get_last_execution_log_filename(self):
        """Writes what the last run did to a file for :mod:`rafcon.utils.execution_log` and returns its name.

        It lies in ``EXECUTION_LOG_PATH`` of the configuration, and has values as people see them, if the run kept a
        journal. The journal itself says more, also after a crash.
        """
        from rafcon import _log_file

        return _log_file.write(self)

    def clear_execution_histories(self):
        """Means nothing: a history belongs to its run, and goes with it."""

    destroy_execution_histories = clear_execution_histories

    def mutable_hash(self, obj_hash=None):
        """A hash of what the machine is made of, added to ``obj_hash`` if one is given."""
        return self.root_state.mutable_hash(obj_hash)

    def get_modification_lock(self):
        """The lock by which scripts exclude one another."""
        return self._modification_lock

    def __copy__(self):
        """The same once more, with an id of its own; it belongs to no folder."""
        return StateMachine(copy(self.root_state), self.version, self.creation_time)

    def __deepcopy__(self, _memo):
        return self.__copy__()

    def start(self):
        """Starts the machine; see :meth:`join`. The same as the engine's ``start`` with the id of this machine."""
        from rafcon.core.singleton import state_machine_execution_engine, state_machine_manager

        if self._state_machine_id not in state_machine_manager.state_machines:
            state_machine_manager.add_state_machine(self)
        state_machine_execution_engine.start(self._state_machine_id)

    def join(self, timeout=None):
        """Waits for the end of the run; False if the time (s) ran out."""
        from rafcon.core.singleton import state_machine_execution_engine

        return state_machine_execution_engine.join(timeout)

    def get_state_by_path(self, path, as_check=False):
        """The state of a path of ids, such as ``state.get_path()`` gives.

        None if there is no such state; that is an error in the log too, unless ``as_check`` is set.
        """
        first, *ids = path.split("/")
        state = self.root_state if first == self.root_state.state_id else None
        for state_id in ids:
            known = state is not None and state_id in state._home.child_ids(state)
            state = state._home.child(state, state_id) if known else None
        if state is None and not as_check:
            logger.error("There is no state with the path '%s' in this state machine", path)
        return state

    def acquire_modification_lock(self, blocking=True):
        """Takes the lock by which scripts exclude one another; True if it was taken."""
        return self._modification_lock.acquire(blocking)

    def release_modification_lock(self):
        """Gives the lock back."""
        self._modification_lock.release()

    @contextmanager
    def modification_lock(self, blocking=True):
        """Context manager around ``acquire_modification_lock``."""
        taken = self.acquire_modification_lock(blocking)
        try:
            yield
        finally:
            if taken:
                self.release_modification_lock()

    def __repr__(self):
        return f"<StateMachine {self._state_machine_id} {getattr(self.root_state, 'name', None)}>"
