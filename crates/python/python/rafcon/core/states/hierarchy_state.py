"""Containers whose states run in sequence."""

from rafcon.core.states.container_state import ContainerState


class HierarchyState(ContainerState):
    """Container that runs its states in sequence, along its transitions."""

    _kind = "hierarchy"
