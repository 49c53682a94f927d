"""Containers that end with the first of their states."""

from rafcon.core.states.concurrency_state import ConcurrencyState


class PreemptiveConcurrencyState(ConcurrencyState):
    """Container that runs its states in parallel; when one has ended, it preempts the others."""

    _kind = "preemptive"
