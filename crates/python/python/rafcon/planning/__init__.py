"""Plans from skills, in Python: :func:`plan` returns a :class:`Plan`, which becomes a machine.

The rules are those of ``rafcon plan``: skills are library states with a planner annotation, each
plan is validated before it is returned, and preemption of the calling state ends the engine.
"""

from rafcon.planning._plans import (
    EngineError, NoPlan, Plan, PlanningError, Refused, Step, Unsolvable, plan,
)
from rafcon.planning._replanning import replan

__all__ = ["EngineError", "NoPlan", "Plan", "PlanningError", "Refused", "Step", "Unsolvable", "plan", "replan"]
