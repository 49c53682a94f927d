from collections.abc import Callable
from typing import Any, TypeVar

_T = TypeVar("_T")

def call_gui_callback(callback: Callable[..., _T], *args: Any, **kwargs: Any) -> _T: ...
