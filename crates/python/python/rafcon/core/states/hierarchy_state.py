"""Containers whose states run one after the other."""

from rafcon.core.states.container_state import ContainerState


class HierarchyState(ContainerState):
    """A container that runs its states one after the other, along its transitions."""

    _kind = "hierarchy"
