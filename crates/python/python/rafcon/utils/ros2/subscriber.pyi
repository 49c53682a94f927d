from typing import Any

from rafcon.core.states.execution_state import ExecutionState

class SubscriberHandle:
    sub_msg: Any
    def __init__(
        self,
        rafcon: ExecutionState,
        node: Any,
        sub_msg_def: Any,
        sub_topic: str,
        qos_profile: Any = 10,
        callback_group: Any = None,
    ) -> None: ...
    def sub_callback(self, msg: Any) -> None: ...
    def wait_for_sub_msg(self, timeout: float | None = None) -> str: ...
    def get_sub_msg(self) -> Any: ...
    def get_sub_msg_field(self, key: str) -> Any: ...
    def replace_chars(self, message: str) -> str: ...
