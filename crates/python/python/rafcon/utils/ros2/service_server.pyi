from collections.abc import Callable
from typing import Any

from rafcon.core.states.execution_state import ExecutionState

class ServiceServerHandle:
    def __init__(
        self,
        rafcon: ExecutionState,
        node: Any,
        srv_def: Any,
        srv_name: str,
        srv_callback: Callable[..., Any],
        callback_group: Any = None,
    ) -> None: ...
    def destroy_service(self) -> None: ...
    def replace_chars(self, message: str) -> str: ...
