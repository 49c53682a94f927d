"""The engine: scripts control the machine that they are part of, programs run those that they have built."""

from rafcon import _embedding, _objects
from rafcon._bridge import native
from rafcon.core.custom_exceptions import CommandNotSupported
from rafcon.core.execution.breakpoint_manager import BreakpointManager
from rafcon.core.execution.execution_status import ExecutionStatus, StateMachineExecutionStatus
from rafcon.design_patterns.observer.observable import Observable
from rafcon.utils.log import get_logger

logger = get_logger(__name__)


class ExecutionEngine(Observable):
    """Runs the state machine. A command takes effect at once and returns at once.

    One that cannot be carried out now is a ``RuntimeError`` that says why.
    """

    def __init__(self, state_machine_manager):
        self.state_machine_manager = state_machine_manager
        self._run = None
        #: Where the run is held: a :class:`~rafcon.core.execution.breakpoint_manager.BreakpointManager`.
        self.breakpoint_manager = BreakpointManager()
        #: ``status.execution_mode`` is a ``StateMachineExecutionStatus``.
        self.status = self._status = ExecutionStatus(_mode)

    @staticmethod
    def instance():
        """The engine of this process."""
        from rafcon.core.singleton import state_machine_execution_engine

        return state_machine_execution_engine

    @Observable.observed
    def pause(self):
        """Holds every hierarchy before its next state; scripts that run go on."""
        native.command("pause")

    @Observable.observed
    def start(self, state_machine_id=None, start_state_path=None):
        """Starts a state machine of this program, the active one unless an id is given; a paused one goes on.

        ``start_state_path`` names the state to begin at. Scripts can only resume the machine that they are part of.
        """
        if not self._begin(state_machine_id, start_state_path):
            native.command("resume")

    def _begin(self, state_machine_id, start_state_path=None, hold=False):
        """Starts a machine of this program, perhaps held before its first state; False if one runs already."""
        if _objects.is_host() or self._is_running():
            return False
        manager = self.state_machine_manager
        if state_machine_id is not None:
            manager.active_state_machine_id = state_machine_id
        machine = manager.get_active_state_machine()
        if machine is None:
            raise AttributeError("there is no active state machine; give the id of one that was added to the manager")
        if self._run is not None:
            self._run.retire()
        self._run = machine.root_state._home.run = _embedding.Run(machine, start_state_path, hold)
        try:
            self._run.begin()
        except RuntimeError:
            self._run = machine.root_state._home.run = None
            raise
        return True

    def _is_running(self):
        return self._run is not None and not self._run.is_over()

    def join(self, timeout=None):
        """Waits for the end of the run; True if it has ended, False if there is none or the time (s) ran out.

        Scripts cannot wait for the machine that they are part of.
        """
        if _objects.is_host():
            raise CommandNotSupported("ExecutionEngine.join")
        return self._run is not None and self._run.join(timeout)

    def execute_state_machine_from_path(
        self, state_machine=None, path=None, start_state_path=None, wait_for_execution_finished=True
    ):
        """Loads a state machine (unless one is given), runs it, and returns it."""
        from rafcon.core.storage import storage

        if _objects.is_host():
            raise CommandNotSupported("ExecutionEngine.execute_state_machine_from_path")
        machine = state_machine or storage.load_state_machine_from_path(path)
        if machine.state_machine_id not in self.state_machine_manager.state_machines:
            self.state_machine_manager.add_state_machine(machine)
        self.start(machine.state_machine_id, start_state_path)
        if wait_for_execution_finished:
            self.join()
        return machine

    @Observable.observed
    def stop(self):
        """Preempts everything; the machine then ends as *preempted*."""
        native.command("stop")

    # ---- step by step

    @Observable.observed
    def step_mode(self, state_machine_id=None):
        """Holds wherever a next state would begin, from now on; a machine of this program is started for it."""
        if not self._begin(state_machine_id, hold=True):
            native.command("step_mode")

    def step_into(self):
        """One state further on every branch that is held, entering it."""
        native.command("step_into")

    def step_over(self):
        """One state further on every branch that is held, running all that is in it."""
        native.command("step_over")

    def step_out(self):
        """To the end of the containers that are held."""
        native.command("step_out")

    def backward_step(self):
        """One step back on every branch that is held."""
        native.command("step_back")

    def run_to_selected_state(self, path, state_machine_id=None):
        """Runs until before the state at a path, and holds there."""
        self._begin(state_machine_id, hold=True)
        native.command("run_to", path)

    def run_selected_state(self, path, state_machine_id=None):
        """Begins again at the state at a path, runs it, and holds. The machine has to be held."""
        self._begin(state_machine_id, hold=True)
        native.command("run_selected", path)

    def run_only_selected_state(self, path, state_machine_id=None):
        """Begins again at the state at a path, runs it, and stops. The machine has to be held."""
        self._begin(state_machine_id, hold=True)
        native.command("run_only_selected", path)

    def replay_from_history(self, call_item, state_machine=None):
        """Begins again at an entry of ``state.execution_history`` with its data. The machine has to be held."""
        native.command("start_from_history", None, call_item.sequence)

    @Observable.observed
    def set_execution_mode(self, execution_mode, notify=True):
        """The mode follows from the commands: refused with ``CommandNotSupported``."""
        raise CommandNotSupported("ExecutionEngine.set_execution_mode")

    # ---- how it stands

    def finished_or_stopped(self):
        """Whether the machine has ended or was told to."""
        return _mode() in (StateMachineExecutionStatus.FINISHED, StateMachineExecutionStatus.STOPPED)

    @property
    def state_machine_running(self):
        """Whether the machine runs (held or not)."""
        return not self.finished_or_stopped()


def _mode():
    machine = _objects.machine_or_none()
    if machine is None:
        return StateMachineExecutionStatus.STOPPED
    root = machine.root_state
    if not root.active:
        return StateMachineExecutionStatus.FINISHED
    if root._signals.preempted:
        return StateMachineExecutionStatus.STOPPED
    return StateMachineExecutionStatus.PAUSED if root._signals.paused else StateMachineExecutionStatus.STARTED
