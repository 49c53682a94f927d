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
    def __init__(self, sequence: int, timestamp: float, path: str, data: str, backward: bool) -> None: ...
    @property
    def history_item_id(self) -> str: ...
    @property
    def state_reference(self) -> State | None: ...
    @property
    def state_type(self) -> str: ...
    @property
    def call_type(self) -> CallType: ...
    @property
    def input_output_data(self) -> dict[str, Any]: ...

class CallItem(HistoryItem):
    outcome: None

class ReturnItem(HistoryItem):
    def __init__(
        self, sequence: int, timestamp: float, path: str, outcome: tuple[int, str], data: str, backward: bool
    ) -> None: ...
    @property
    def outcome(self) -> Outcome: ...

def item(
    sequence: int, timestamp: float, path: str, outcome: tuple[int, str] | None, data: str, backward: bool
) -> CallItem | ReturnItem: ...
