"""Status of the engine."""

import threading
from enum import Enum

StateMachineExecutionStatus = Enum(
    "STATE_MACHINE_EXECUTION_STATUS",
    "STARTED STOPPED PAUSED FINISHED STEP_MODE FORWARD_INTO FORWARD_OVER FORWARD_OUT BACKWARD "
    "RUN_TO_SELECTED_STATE RUN_SELECTED_STATE RUN_ONLY_SELECTED_STATE",
    module=__name__,
)


class ExecutionStatus:
    """Status of the engine, read anew with each access to ``execution_mode``."""

    def __init__(self, read):
        self._read = read
        #: For programs that guard their access to the engine's status; the engine itself does not need it.
        self.execution_condition_variable = threading.Condition()

    @property
    def execution_mode(self):
        """Current mode, a ``StateMachineExecutionStatus``."""
        return self._read()
