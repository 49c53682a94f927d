"""Containers whose states run in parallel."""

from rafcon.core.states.container_state import ContainerState


class ConcurrencyState(ContainerState):
    """Container that runs all its states in parallel."""

    _kind = None
