from collections.abc import Callable
from enum import Enum
from threading import Condition

class StateMachineExecutionStatus(Enum):
    STARTED = 1
    STOPPED = 2
    PAUSED = 3
    FINISHED = 4
    STEP_MODE = 5
    FORWARD_INTO = 6
    FORWARD_OVER = 7
    FORWARD_OUT = 8
    BACKWARD = 9
    RUN_TO_SELECTED_STATE = 10
    RUN_SELECTED_STATE = 11
    RUN_ONLY_SELECTED_STATE = 12

class ExecutionStatus:
    execution_condition_variable: Condition
    def __init__(self, read: Callable[[], StateMachineExecutionStatus]) -> None: ...
    @property
    def execution_mode(self) -> StateMachineExecutionStatus: ...
