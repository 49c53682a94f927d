"""The running state machine."""

import threading
from contextlib import contextmanager

from rafcon import _objects
from rafcon.core._refusals import NoConstructor, fixed, refuses
from rafcon.core.execution.execution_history import ExecutionHistory
from rafcon.utils.log import get_logger

logger = get_logger(__name__)


@refuses("change_root_state_type", "start")
class StateMachine(NoConstructor):
    """The state machine that runs; ``state.get_state_machine()`` gives it."""

    def _bind(self, facts):
        self._facts = facts
        self._modification_lock = threading.RLock()

    @property
    def state_machine_id(self):
        """Always 1: a process runs one machine."""
        return 1

    @fixed
    def root_state(self):
        """The root state."""
        return _objects.state(self._facts["root"])

    @property
    def file_system_path(self):
        """The folder (``str``) of the state machine, or None."""
        return self._facts["file_system_path"]

    @fixed
    def version(self):
        """The version that the author gave it, or None."""
        return self._facts["version"]

    @fixed
    def creation_time(self):
        """When it was made, as text in UTC."""
        return self._facts["creation_time"]

    @property
    def marked_dirty(self):
        """Whether it has changes that are not saved; a running machine has none."""
        return False

    @property
    def execution_histories(self):
        """One history for each run of this process."""
        return [ExecutionHistory(self.root_state)]

    def get_state_by_path(self, path, as_check=False):
        """The state of a path of ids, such as ``state.get_path()`` gives.

        None if there is no such state; that is an error in the log too, unless ``as_check`` is set.
        """
        first, *ids = path.split("/")
        state = self.root_state if first == self.root_state.state_id else None
        for state_id in ids:
            places = state._facts["children"] if state is not None else {}
            state = _objects.state(places[state_id]) if state_id in places else None
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
        return f"<StateMachine {self.root_state.name}>"
