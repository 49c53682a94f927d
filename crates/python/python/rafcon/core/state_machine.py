"""State machines: the running one, and those that are built or loaded."""

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
    """State machine; ``state.get_state_machine()`` returns that of a state."""

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
        """Make this object represent the running machine."""
        self._init(1)
        self._facts = facts
        self._marked_dirty = False

    @classmethod
    def _loaded(cls, document, state_machine_id=None):
        """Create a machine from a document that was read from files."""
        creation_time, version, _folder = document.header()
        machine = cls(None, version, creation_time, state_machine_id)
        root = _objects.blank_state(document.fact(document.root_id(), "kind"))
        root._settle_alone(document, document.root_id())
        machine.root_state = root
        machine._marked_dirty = False
        return machine

    @property
    def state_machine_id(self):
        """Id (``int``) in this process."""
        return self._state_machine_id

    @property
    def root_state(self):
        """Root state. Assigning a state that belongs elsewhere moves it and leaves a copy there."""
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
        """Change the class of the root and return the new object for it."""
        root = self.root_state
        root._change("state.kind", new_state_class._kind)
        if self._facts is None:
            self._root = root._home.replaced(None, root)
        return self.root_state

    @property
    def _document(self):
        """Document of the machine in the compiled module, with all changes of users."""
        if self._root is None:
            raise AttributeError("the state machine has no root state yet")
        home = self._root._home
        home.store_notes()
        home.document.set_header(self._creation_time, self._version)
        return home.document

    @property
    def file_system_path(self):
        """Folder (``str``) of the state machine, or None."""
        if self._facts is not None:
            return self._facts["file_system_path"]
        return None if self._root is None else self._root._home.document.header()[2]

    @property
    def version(self):
        """Version that the author assigned, or None."""
        return self._version if self._facts is None else self._facts["version"]

    @version.setter
    def version(self, version):
        if self._facts is not None:
            raise MachineChangeNotSupported("StateMachine.version = …")
        self._version = version
        self._marked_dirty = True

    @property
    def creation_time(self):
        """Time of creation as text, in UTC."""
        return self._creation_time if self._facts is None else self._facts["creation_time"]

    @property
    def marked_dirty(self):
        """True if there are unsaved changes."""
        return self._marked_dirty

    @marked_dirty.setter
    def marked_dirty(self, marked_dirty):
        self._marked_dirty = bool(marked_dirty)

    @property
    def execution_histories(self):
        """List with one history for each run of this process."""
        return [ExecutionHistory(self.root_state)]

    def get_last_execution_log_filename(self):
        """Write a log of the last run for :mod:`rafcon.utils.execution_log`; return its name.

        The folder is ``EXECUTION_LOG_PATH`` of the configuration. The log has values in readable
        form, if the run kept a journal. The journal itself has more details, also after a crash.
        """
        from rafcon import _log_file

        return _log_file.write(self)

    def clear_execution_histories(self):
        """Do nothing: a history is discarded with its run."""

    destroy_execution_histories = clear_execution_histories

    def mutable_hash(self, obj_hash=None):
        """Hash of the machine's content, added to ``obj_hash`` if given."""
        return self.root_state.mutable_hash(obj_hash)

    def get_modification_lock(self):
        """Lock with which scripts exclude one another."""
        return self._modification_lock

    def __copy__(self):
        """Copy of the machine with a new id and without a folder."""
        return StateMachine(copy(self.root_state), self.version, self.creation_time)

    def __deepcopy__(self, _memo):
        return self.__copy__()

    def start(self):
        """Start the machine, like the engine's ``start`` with its id; see :meth:`join`."""
        from rafcon.core.singleton import state_machine_execution_engine, state_machine_manager

        if self._state_machine_id not in state_machine_manager.state_machines:
            state_machine_manager.add_state_machine(self)
        state_machine_execution_engine.start(self._state_machine_id)

    def join(self, timeout=None):
        """Wait for the end of the run; False if no run was started or the timeout (s) expired."""
        from rafcon.core.singleton import state_machine_execution_engine

        return state_machine_execution_engine.join(timeout)

    def get_state_by_path(self, path, as_check=False):
        """State with a path of ids, such as ``state.get_path()`` returns.

        None if there is no such state; this also logs an error, unless ``as_check`` is set.
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
        """Acquire the lock with which scripts exclude one another; True if it was acquired."""
        return self._modification_lock.acquire(blocking)

    def release_modification_lock(self):
        """Release the lock."""
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
