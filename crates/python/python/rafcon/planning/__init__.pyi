import os
from collections.abc import Callable, Iterable, Iterator, Mapping, MutableMapping
from dataclasses import dataclass
from typing import Any, Literal

from rafcon.core.state_machine import StateMachine
from rafcon.core.states.state import State

__all__ = ["EngineError", "NoPlan", "Plan", "PlanningError", "Refused", "Step", "Unsolvable", "plan", "replan"]

class PlanningError(Exception): ...

class Refused(PlanningError):
    findings: list[dict[str, Any]]
    def __init__(self, findings: list[dict[str, Any]]) -> None: ...

class Unsolvable(PlanningError): ...
class NoPlan(PlanningError): ...
class EngineError(PlanningError): ...

@dataclass(frozen=True)
class Step:
    action: str
    objects: tuple[str, ...]
    library: str
    title: str
    start: float
    duration: float | None
    needs: tuple[tuple[str, int | None], ...]
    brings: tuple[tuple[str, tuple[int, ...], bool], ...]

@dataclass(frozen=True)
class Plan:
    steps: tuple[Step, ...]
    cost: float | None
    makespan: float
    lost: float
    findings: tuple[dict[str, Any], ...]
    _found: dict[str, Any]
    def __len__(self) -> int: ...
    def __iter__(self) -> Iterator[Step]: ...
    def explain(self) -> str: ...
    def save(self, folder: str | os.PathLike[str]) -> None: ...
    def to_machine(self) -> StateMachine: ...

def plan(
    pool: str | Iterable[str],
    facts: str,
    goal: str | None = None,
    *,
    types: Mapping[str, str] | None = None,
    data: Mapping[str, Any] | None = None,
    engine: str = "kairos",
    time_limit: float = 10.0,
    anytime: bool = False,
    parallel: bool = False,
    retries: int = 0,
    then: Literal["give_up", "ask", "replan"] = "give_up",
    observe: str | None = None,
    replans_max: int | None = None,
    name: str | None = None,
    on_plan: Callable[[Plan], object] | None = None,
    state: State | None = None,
) -> Plan: ...
def replan(state: State, inputs: Mapping[str, Any], outputs: MutableMapping[str, Any] | None = None) -> str: ...
