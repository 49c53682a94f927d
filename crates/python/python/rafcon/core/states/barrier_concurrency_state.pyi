from typing import Any

from rafcon.core.state_elements.logical_port import Outcome
from rafcon.core.states.concurrency_state import ConcurrencyState
from rafcon.core.states.execution_state import ExecutionState
from rafcon.core.states.state import State

UNIQUE_DECIDER_STATE_ID: str

class BarrierConcurrencyState(ConcurrencyState):
    def __init__(
        self, *arguments: Any, decider_state: DeciderState | None = None, load_from_storage: bool = False, **named: Any
    ) -> None: ...
    def add_state(self, state: State, storage_load: bool = False) -> str: ...

class DeciderState(ExecutionState):
    child_errors: dict[str, tuple[str, Any]]
    final_outcomes_dict: dict[str, tuple[str, Outcome]]
    def get_outcome_for_state_name(self, name: str) -> Outcome | None: ...
    def get_outcome_for_state_id(self, state_id: str) -> Outcome | None: ...
    def get_errors_for_state_name(self, name: str) -> Any: ...
