"""Plans as Python objects: request, content, and conversion to a machine."""

import json
import os
import sys
import tempfile
from dataclasses import dataclass, field

from rafcon._bridge import native
from rafcon.core.custom_exceptions import StatePreempted
from rafcon.core.singleton import library_manager

#: Interval of checks for preemption, in seconds.
_LISTEN_S = 0.02


class PlanningError(Exception):
    """Planning failed; the message gives the reason. See the subclasses."""


class Refused(PlanningError):
    """Skills, facts or goal are inconsistent: ``findings`` lists the problems."""

    def __init__(self, findings):
        errors = [finding for finding in findings if finding["is_error"]]
        super().__init__("\n".join(_finding(finding) for finding in errors or findings))
        self.findings = findings


class Unsolvable(PlanningError):
    """The goal cannot be reached."""


class NoPlan(PlanningError):
    """The engine has found no plan within its time limit."""


class EngineError(PlanningError):
    """The engine is missing, fails, or returns invalid plans."""


_ERRORS = {"impossible": Unsolvable, "not_found": NoPlan, "failed": EngineError}


def _finding(finding):
    return ": ".join([*finding.get("libraries", []), finding["text"]])


@dataclass(frozen=True)
class Step:
    """Action of a plan."""

    #: The name of the action.
    action: str
    #: The objects, one for each parameter.
    objects: tuple
    #: Library of the skill.
    library: str
    #: Name of the skill's state.
    title: str
    #: Planned start; the index of the step for a plan without times.
    start: float
    #: Planned duration; None for an action without duration.
    duration: "float | None"
    #: Required facts, each with the index of the step that provides it, or None.
    needs: tuple
    #: Provided facts, each with the indices of the steps that need it, and a flag for the goal.
    brings: tuple

    def __str__(self):
        return "(" + " ".join([self.action, *self.objects]) + ")"


@dataclass(frozen=True)
class Plan:
    """Valid plan."""

    steps: tuple
    #: Cost reported by the engine.
    cost: "float | None"
    #: Planned duration; 0 for a plan without times.
    makespan: float
    #: Additional duration of its machine.
    lost: float
    #: Problems found in skills or facts.
    findings: tuple
    _found: dict = field(repr=False)

    def __len__(self):
        return len(self.steps)

    def __iter__(self):
        return iter(self.steps)

    def __str__(self):
        return "\n".join(map(str, self.steps))

    def explain(self):
        """Steps as text, with the facts that each needs and provides."""
        lines = []
        for index, step in enumerate(self.steps, 1):
            lines.append(f"{index} {step}")
            needs = [fact if source is None else f"{fact} from {source + 1}" for fact, source in step.needs]
            brings = []
            for fact, steps, goal in step.brings:
                users = [str(user + 1) for user in steps] + (["the goal"] if goal else [])
                brings.append(f"{fact} for {', '.join(users)}")
            for word, facts in (("needs", needs), ("brings", brings)):
                if facts:
                    lines.append(f"  {word} {', '.join(facts)}")
        return "\n".join(lines)

    def save(self, folder):
        """Write the machine of the plan to a folder."""
        native.save_plan(json.dumps(self._found), library_manager._roots(), os.fspath(folder))

    def to_machine(self):
        """Load the machine of the plan as a :class:`rafcon.core.state_machine.StateMachine`.

        It has no folder of its own, and is not saved.
        """
        from rafcon.core.storage import storage

        with tempfile.TemporaryDirectory(prefix="rafcon-plan-") as folder:
            path = os.path.join(folder, "machine")
            self.save(path)
            return storage.load_state_machine_from_path(path)


def _plan(found):
    steps = tuple(
        Step(
            step["action"],
            tuple(step["objects"]),
            step["library"],
            step["title"],
            step["start"],
            step.get("duration"),
            tuple((need["fact"], need.get("from")) for need in step["needs"]),
            tuple((gain["fact"], tuple(gain["steps"]), gain["goal"]) for gain in step["brings"]),
        )
        for step in found["steps"]
    )
    findings = tuple(found.get("findings", ()))
    return Plan(steps, found.get("cost"), found["makespan"], found["lost"], findings, found)


def plan(
    pool,
    facts,
    goal=None,
    *,
    types=None,
    data=None,
    engine="kairos",
    time_limit=10.0,
    anytime=False,
    parallel=False,
    retries=0,
    then="give_up",
    observe=None,
    replans_max=None,
    name=None,
    on_plan=None,
    state=None,
):
    """Request a plan from an engine and return it; raises a :class:`PlanningError` if that fails.

    ``pool`` is a library path with skills, or a list of them. ``facts`` is a PDDL problem as text,
    and ``goal`` a PDDL condition that replaces the problem's. ``types`` maps types to their parent
    types, and ``data`` objects to their runtime data. ``time_limit`` is in seconds. ``then`` is the
    action after a failed step whose skill has none: ``give_up``, ``ask`` or ``replan`` (with the
    library ``observe``). ``on_plan`` is called with each plan, including plans that are followed by
    a better one (``anytime``). With ``state``, preemption of that state ends the engine and raises
    ``StatePreempted``.
    """
    request = {
        "pool": {"libraries": [pool] if isinstance(pool, str) else list(pool), "types": dict(types or {})},
        "facts": facts,
        "goal": goal,
        "data": dict(data or {}),
        "engine": engine,
        "time_limit_ms": max(1, round(time_limit * 1000)),
        "anytime": anytime,
        "parallel": parallel,
        "recovery": {"retries": retries, "then": then},
        "observe": observe,
        "replans_max": replans_max,
        "name": name,
    }
    planning = native.Planning(json.dumps(request), library_manager._roots(), sys.executable)
    best = None
    while True:
        try:
            line = planning.next(_LISTEN_S)
        except BaseException:
            planning.cancel()
            raise
        if line is None:
            if state is not None and state.preempted:
                planning.cancel()
                raise StatePreempted()
            continue
        event = json.loads(line)
        kind = event.pop("event")
        if kind == "found":
            best = _plan(event)
            if on_plan is not None:
                on_plan(best)
        elif kind == "done":
            return best
        elif kind == "refused":
            raise Refused(event["findings"])
        else:
            raise _ERRORS.get(kind, PlanningError)(event["reason"])
