"""What the engine does."""

import threading
from enum import Enum

StateMachineExecutionStatus = Enum(
    "STATE_MACHINE_EXECUTION_STATUS",
    "STARTED STOPPED PAUSED FINISHED STEP_MODE FORWARD_INTO FORWARD_OVER FORWARD_OUT BACKWARD "
    "RUN_TO_SELECTED_STATE RUN_SELECTED_STATE RUN_ONLY_SELECTED_STATE",
    module=__name__,
)


class ExecutionStatus:
    """What the engine does at the moment when ``execution_mode`` is read."""

    def __init__(self, read):
        self._read = read
        #: For programs that guard their access to the engine's status; the engine itself does not need it.
        self.execution_condition_variable = threading.Condition()

    @property
    def execution_mode(self):
        """A ``StateMachineExecutionStatus``."""
        return self._read()
