from collections.abc import Callable
from typing import Any, TypeVar

from rafcon.design_patterns.observer.wrappers import WrapperBase

_Method = TypeVar("_Method", bound=Callable[..., Any])

OBSERVABLES: str

class Observable(WrapperBase):
    def __init__(self) -> None: ...
    @staticmethod
    def observed(function: _Method) -> _Method: ...
    def add_observer(
        self,
        observer: object,
        key: str,
        notify_before_function: Callable[..., Any] | None = None,
        notify_after_function: Callable[..., Any] | None = None,
    ) -> None: ...

class Signal(Observable):
    def emit(self, args: Any = None) -> None: ...

class ObservableMetaclass(type):
    def __init__(cls, name: str, bases: tuple[type, ...], members: dict[str, Any]) -> None: ...
    @classmethod
    def add(cls, metaclass: type) -> type: ...
