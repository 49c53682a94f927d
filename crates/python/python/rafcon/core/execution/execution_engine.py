"""The engine as scripts see it: they pause, resume and stop the machine that they are part of."""

from rafcon import _objects
from rafcon._bridge import native
from rafcon.core.custom_exceptions import CommandNotSupported
from rafcon.core.execution.execution_status import ExecutionStatus, StateMachineExecutionStatus

_UNKNOWN = (
    "step_mode",
    "step_into",
    "step_over",
    "step_out",
    "backward_step",
    "run_to_selected_state",
    "run_selected_state",
    "run_only_selected_state",
    "replay_from_history",
    "execute_state_machine_from_path",
    "set_execution_mode",
    "join",
)


class ExecutionEngine:
    """Runs the state machine. A command takes effect at once and returns at once."""

    def __init__(self, state_machine_manager):
        self.state_machine_manager = state_machine_manager
        #: ``status.execution_mode`` is a ``StateMachineExecutionStatus``.
        self.status = ExecutionStatus(_mode)

    @staticmethod
    def instance():
        """The engine of this process."""
        from rafcon.core.singleton import state_machine_execution_engine

        return state_machine_execution_engine

    def pause(self):
        """Holds every hierarchy before its next state; scripts that run go on."""
        native.command("pause")

    def start(self, state_machine_id=None, start_state_path=None):
        """Resumes the machine. It runs, so the arguments, for a fresh start, mean nothing here."""
        native.command("resume")

    def stop(self):
        """Preempts everything; the machine then ends as *preempted*."""
        native.command("stop")

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


def _refusing(name):
    def method(self, *_arguments, **_named):
        raise CommandNotSupported("ExecutionEngine." + name)

    method.__name__ = name
    method.__doc__ = "Not known to this version: refused with ``CommandNotSupported``."
    return method


for _name in _UNKNOWN:
    setattr(ExecutionEngine, _name, _refusing(_name))
