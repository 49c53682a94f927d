from collections.abc import Callable
from logging import Logger
from typing import Any, TypeVar

_Function = TypeVar("_Function", bound=Callable[..., Any])

VERBOSE: int

class RAFCONDeprecationWarning(DeprecationWarning): ...

def get_logger(name: str) -> Logger: ...
def log_exceptions(logger: Logger | None = None) -> Callable[[_Function], _Function]: ...
