"""Containers whose states run at the same time."""

from rafcon.core.states.container_state import ContainerState


class ConcurrencyState(ContainerState):
    """A container that runs all its states at the same time."""

    _kind = None
