from typing import Any

from rafcon.core.state_elements.data_port import DataPort
from rafcon.core.state_elements.state_element import StateElement
from rafcon.core.states.state import State

def generate_time_stamp() -> int: ...

class ScopedVariable(DataPort):
    def __init__(
        self,
        name: str | None = None,
        data_type: type | str | None = None,
        default_value: Any = None,
        scoped_variable_id: int | None = None,
        parent: State | None = None,
    ) -> None: ...

class ScopedData(StateElement):
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> Any: ...
    @property
    def value_type(self) -> type[Any]: ...
    @property
    def from_state(self) -> str: ...
    @property
    def data_port_type(self) -> type[DataPort]: ...
    def __init__(
        self,
        name: str,
        value: Any,
        value_type: type,
        from_state: str,
        data_port_type: type[DataPort],
        parent: State | None = None,
    ) -> None: ...
