"""Containers that end with the first of their states."""

from rafcon.core.states.concurrency_state import ConcurrencyState


class PreemptiveConcurrencyState(ConcurrencyState):
    """A container that runs all its states at the same time and preempts the others when the first is done."""

    _kind = "preemptive"
