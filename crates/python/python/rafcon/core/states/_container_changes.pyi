from collections.abc import Iterable
from typing import Any, TypeVar

from rafcon.core.state_elements.data_flow import DataFlow
from rafcon.core.state_elements.scope import ScopedVariable
from rafcon.core.state_elements.transition import Transition
from rafcon.core.states._changes import StateChanges
from rafcon.core.states.hierarchy_state import HierarchyState
from rafcon.core.states.state import State

_State = TypeVar("_State", bound=State)

class ContainerChanges(StateChanges):
    def add_state(self, state: State, storage_load: bool = False) -> str: ...
    def remove_state(
        self, state_id: str | State, recursive: bool = True, force: bool = False, destroy: bool = True
    ) -> State: ...
    def set_start_state(self, state: State | str | None) -> None: ...
    def group_states(
        self, state_ids: str | Iterable[str], scoped_variables: int | Iterable[int] | None = None
    ) -> HierarchyState: ...
    def ungroup_state(self, state_id: str) -> State: ...
    def substitute_state(self, state_id: str, state: _State) -> _State: ...
    def change_state_type(self, state: State, new_state_class: type[_State]) -> _State: ...
    def add_transition(
        self,
        from_state_id: str | None,
        from_outcome: int | None,
        to_state_id: str | None,
        to_outcome: int | None,
        transition_id: int | None = None,
    ) -> int: ...
    def remove_transition(self, transition_id: int, destroy: bool = True) -> Transition: ...
    def add_data_flow(
        self,
        from_state_id: str,
        from_data_port_id: int,
        to_state_id: str,
        to_data_port_id: int,
        data_flow_id: int | None = None,
    ) -> int: ...
    def remove_data_flow(self, data_flow_id: int, destroy: bool = True) -> DataFlow: ...
    def add_scoped_variable(
        self,
        name: str,
        data_type: type | str | None = None,
        default_value: Any = None,
        scoped_variable_id: int | None = None,
    ) -> int: ...
    def remove_scoped_variable(self, scoped_variable_id: int, destroy: bool = True) -> ScopedVariable: ...
