from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

__all__ = ["Checks", "Number", "Pressed", "Text", "ask", "checks", "number", "text"]

@dataclass(frozen=True)
class Pressed:
    button: int
    label: str
    timed_out: bool

@dataclass(frozen=True)
class Text(Pressed):
    text: str

@dataclass(frozen=True)
class Number(Pressed):
    number: float

@dataclass(frozen=True)
class Checks(Pressed):
    checked: tuple[bool, ...]

def ask(message: str, buttons: Sequence[str] = ("OK",), timeout: float | None = None, default: Any = None, lost_link: float | None = None) -> Pressed: ...
def text(
    message: str, initial: str = "", buttons: Sequence[str] = ..., timeout: float | None = None, default: Any = None, lost_link: float | None = None
) -> Text: ...
def number(
    message: str,
    minimum: float | None = None,
    maximum: float | None = None,
    initial: float | None = None,
    whole: bool = False,
    buttons: Sequence[str] = ...,
    timeout: float | None = None,
    default: Any = None,
    lost_link: float | None = None,
) -> Number: ...
def checks(
    message: str,
    boxes: Sequence[str],
    initial: Iterable[bool] = (),
    buttons: Sequence[str] = ...,
    timeout: float | None = None,
    default: Any = None,
    lost_link: float | None = None,
) -> Checks: ...
