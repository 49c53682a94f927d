from collections.abc import Callable
from typing import Any, TypeVar

_Method = TypeVar("_Method", bound=Callable[..., Any])

global_lock_counter: int

def lock_state_machine(method: _Method) -> _Method: ...
