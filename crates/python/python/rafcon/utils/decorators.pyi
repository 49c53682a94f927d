from collections.abc import Callable
from typing import Any, TypeVar

_Function = TypeVar("_Function", bound=Callable[..., Any])

def avoid_parallel_execution(func: _Function) -> _Function: ...
