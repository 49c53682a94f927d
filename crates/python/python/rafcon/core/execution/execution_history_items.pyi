from collections.abc import Sequence
from enum import Enum
from typing import Any

from rafcon.core.state_elements.logical_port import Outcome
from rafcon.core.states.state import State

class CallType(Enum):
    EXECUTE = 1
    CONTAINER = 2

class HistoryItem:
    sequence: int
    timestamp: float
    path: str
    backward: bool
    call_type: CallType
    def __init__(
        self,
        sequence: int,
        timestamp: float,
        path: str,
        data: str,
        backward: bool,
        call_type: CallType = ...,
    ) -> None: ...
    @property
    def history_item_id(self) -> str: ...
    @property
    def state_reference(self) -> State | None: ...
    @property
    def state_type(self) -> str: ...
    @property
    def call_type_str(self) -> str: ...
    @property
    def input_output_data(self) -> dict[str, Any]: ...
    def to_dict(self, pickled: bool = True) -> dict[str, Any]: ...

class StateMachineStartItem(HistoryItem): ...
class ConcurrencyItem(HistoryItem): ...
class ScopedDataItem(HistoryItem): ...

class CallItem(ScopedDataItem):
    outcome: None

class ReturnItem(ScopedDataItem):
    def __init__(
        self,
        sequence: int,
        timestamp: float,
        path: str,
        outcome: tuple[int, str],
        data: str,
        backward: bool,
        call_type: CallType = ...,
    ) -> None: ...
    @property
    def outcome(self) -> Outcome: ...

def items(
    told: tuple[int, float, str, tuple[int, str] | None, str, bool], call_types: Sequence[CallType]
) -> list[CallItem | ReturnItem]: ...
