"""The engine, with which scripts control their own machine and programs run machines."""

from rafcon import _embedding, _objects
from rafcon._bridge import native
from rafcon.core.config import global_config
from rafcon.core.custom_exceptions import CommandNotSupported
from rafcon.core.execution.breakpoint_manager import BreakpointManager
from rafcon.core.execution.execution_status import ExecutionStatus, StateMachineExecutionStatus
from rafcon.design_patterns.observer.observable import Observable
from rafcon.utils.log import get_logger

logger = get_logger(__name__)

#: Mode after each stepping command; it stays until the machine resumes.
_STEPS = {
    "step_mode": StateMachineExecutionStatus.STEP_MODE,
    "step_into": StateMachineExecutionStatus.FORWARD_INTO,
    "step_over": StateMachineExecutionStatus.FORWARD_OVER,
    "step_out": StateMachineExecutionStatus.FORWARD_OUT,
    "step_back": StateMachineExecutionStatus.BACKWARD,
    "run_to": StateMachineExecutionStatus.RUN_TO_SELECTED_STATE,
    "run_selected": StateMachineExecutionStatus.FORWARD_OVER,
    "run_only_selected": StateMachineExecutionStatus.RUN_ONLY_SELECTED_STATE,
    "start_from_history": StateMachineExecutionStatus.RUN_TO_SELECTED_STATE,
}
#: Mode during each command that runs to a target.
_RUNS = {
    "run_to": StateMachineExecutionStatus.RUN_TO_SELECTED_STATE,
    "run_selected": StateMachineExecutionStatus.RUN_SELECTED_STATE,
    "run_only_selected": StateMachineExecutionStatus.RUN_ONLY_SELECTED_STATE,
}


class ExecutionEngine(Observable):
    """Runs the state machine. A command takes effect immediately and does not block.

    Raises ``RuntimeError`` with the reason if a command is not possible at the moment.
    """

    def __init__(self, state_machine_manager):
        self.state_machine_manager = state_machine_manager
        self._run = None
        #: Breakpoints of the run: a :class:`~rafcon.core.execution.breakpoint_manager.BreakpointManager`.
        self.breakpoint_manager = BreakpointManager()
        self._last_command = None
        # True if the run was started under external control; its initial hold is then ignored.
        self._is_led = False
        #: Number of times that a branch was held, in runs of this program; may be set. A step is over when it has grown.
        self.synchronization_counter = 0
        #: ``status.execution_mode`` is a ``StateMachineExecutionStatus``.
        self.status = self._status = ExecutionStatus(self._mode)

    @staticmethod
    def instance(*arguments, **named):
        """Engine of this process; arguments have no effect."""
        from rafcon.core.singleton import state_machine_execution_engine

        return state_machine_execution_engine

    def _command(self, name, *arguments):
        native.command(name, *arguments)
        self._last_command = name

    @Observable.observed
    def pause(self):
        """Hold every hierarchy before its next state; running scripts continue."""
        self._command("pause")

    @Observable.observed
    def start(self, state_machine_id=None, start_state_path=None, inputs=None, journal=None):
        """Start a state machine of this program, by default the active one, or resume a paused one.

        ``start_state_path`` is the path of the state to begin at. ``inputs`` maps names of the
        root's input ports to values. ``journal`` is True to keep the run in the folder of ``rafcon
        run``, or the path of another folder; None selects the value of
        ``FILE_SYSTEM_EXECUTION_HISTORY_ENABLE`` in the configuration. Scripts can only resume their
        own machine.
        """

        def begin():
            return self._begin(state_machine_id, {"start_from": start_state_path}, inputs, journal)

        if not begin():
            self._command_or(begin, "resume")

    def _command_or(self, begin, name, *arguments):
        """Send a command to the current run, or begin another if it has ended; True if begun."""
        try:
            self._command(name, *arguments)
        except RuntimeError:
            if _objects.is_host() or self._mode() is not StateMachineExecutionStatus.FINISHED:
                raise
            self._run.join()
            if not begin():
                raise
            return True
        return False

    def _begin(self, state_machine_id, wanted, inputs=None, journal=None, is_led=False):
        """Start a machine of this program with fields for its launch; False if one is running."""
        if _objects.is_host() or self._is_running():
            return False
        manager = self.state_machine_manager
        if state_machine_id is not None:
            manager.active_state_machine_id = state_machine_id
        machine = manager.get_active_state_machine()
        if machine is None:
            raise AttributeError("there is no active state machine; give the id of one that was added to the manager")
        if journal is None:
            journal = bool(global_config.get_config_value("FILE_SYSTEM_EXECUTION_HISTORY_ENABLE"))
        folder = _embedding.run_folder(machine, journal) if journal else None
        inputs = machine.root_state._given_inputs if inputs is None else inputs
        self._is_led = is_led
        self._launch(machine, wanted, inputs, folder)
        return True

    def _launch(self, machine, wanted, inputs=None, folder=None):
        if self._run is not None:
            self._run.retire()
        self._last_command = None
        run = _embedding.Run(machine, self, wanted, inputs, folder)
        self._run = machine.root_state._home.run = run
        try:
            run.begin()
        except RuntimeError:
            self._run = machine.root_state._home.run = None
            raise

    def _held(self, by):
        """Count a branch of the run that was held, unless by a start under external control."""
        if by != "start" or not self._is_led:
            self.synchronization_counter += 1

    def _ended(self, run):
        """Deactivate the machine of a run that has ended."""
        manager = self.state_machine_manager
        if manager._active_id == run.machine.state_machine_id:
            manager._active_id = None

    def _is_running(self):
        return self._run is not None and not self._run.is_over()

    @property
    def run_folder(self):
        """Folder (``str``) of the last run's journal; None if it has none."""
        return None if self._run is None else self._run.folder

    def join(self, timeout=None):
        """Wait for the end of the run. False if no run was started or the timeout (s) expired.

        Scripts cannot wait for their own machine: ``CommandNotSupported``.
        """
        if _objects.is_host():
            raise CommandNotSupported("ExecutionEngine.join")
        return self._run is not None and self._run.join(timeout)

    def execute_state_machine_from_path(
        self, state_machine=None, path=None, start_state_path=None, wait_for_execution_finished=True
    ):
        """Load a state machine (unless one is given), run it, and return it."""
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
        """Preempt all states; the machine then ends as *preempted*. No effect if none runs."""
        if not _objects.is_host() and not self._is_running():
            return
        try:
            self._command("stop")
        except RuntimeError:
            if not self.finished_or_stopped():
                raise

    # ---- step by step

    @Observable.observed
    def step_mode(self, state_machine_id=None):
        """Hold before each next state from now on; start a machine of this program if none runs."""

        def begin():
            return self._begin(state_machine_id, {"hold": True})

        if begin() or self._command_or(begin, "step_mode"):
            self._last_command = "step_mode"

    def step_into(self):
        """Advance every held branch by one state, entering it."""
        self._command("step_into")

    def step_over(self):
        """Advance every held branch by one state, running all that is inside."""
        self._command("step_over")

    def step_out(self):
        """Run to the end of the held containers."""
        self._command("step_out")

    def backward_step(self):
        """Take every held branch one step back."""
        self._command("step_back")

    def _lead(self, state_machine_id, name, path):
        """Send a command about a state, to a machine that is started for it if none is running."""

        def begin():
            return self._begin(state_machine_id, {"hold": True}, is_led=True)

        begin()
        if self._command_or(begin, name, path):
            self._command(name, path)

    def run_to_selected_state(self, path, state_machine_id=None):
        """Run up to the state at a path, and hold before it."""
        self._lead(state_machine_id, "run_to", path)

    def run_selected_state(self, path, state_machine_id=None):
        """Begin again at the state at a path, run it, and hold. The machine must be held."""
        self._lead(state_machine_id, "run_selected", path)

    def run_only_selected_state(self, path, state_machine_id=None):
        """Begin again at the state at a path, run it, and stop. The machine must be held."""
        self._lead(state_machine_id, "run_only_selected", path)

    def replay_from_history(self, call_item, state_machine=None):
        """Begin again at an entry of ``state.execution_history``, with its data, and hold there.

        The run must be held or, in the program that started it, have ended. It must have a journal.
        """
        run = self._run
        if run is None or not run.is_over():
            self._command("start_from_history", None, call_item.sequence)
            return
        if run.folder is None:
            raise RuntimeError(
                "the last run has no journal, so it cannot restart from its history; start it with `journal=True`"
            )
        self.state_machine_manager.active_state_machine_id = run.machine.state_machine_id
        self._is_led = False
        self._launch(run.machine, {"resume": {"from": call_item.sequence}}, folder=run.folder)
        self._last_command = "start_from_history"

    @Observable.observed
    def set_execution_mode(self, execution_mode, notify=True):
        """Raise ``CommandNotSupported``: the mode follows from the commands."""
        raise CommandNotSupported("ExecutionEngine.set_execution_mode")

    # ---- status

    def finished_or_stopped(self):
        """True if no machine is running, or the running one is stopping."""
        return self._mode() in (StateMachineExecutionStatus.FINISHED, StateMachineExecutionStatus.STOPPED)

    @property
    def state_machine_running(self):
        """True if the machine is running or held, and not stopping."""
        return not self.finished_or_stopped()

    def _mode(self):
        try:
            status = native.run_status()
        except RuntimeError:
            return StateMachineExecutionStatus.STOPPED
        if status == "finished":
            return StateMachineExecutionStatus.FINISHED
        if status == "stopping":
            return StateMachineExecutionStatus.STOPPED
        if status == "paused":
            return StateMachineExecutionStatus.PAUSED
        if status == "stepping":
            return _STEPS.get(self._last_command, StateMachineExecutionStatus.STEP_MODE)
        return _RUNS.get(self._last_command, StateMachineExecutionStatus.STARTED)
