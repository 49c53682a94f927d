"""Elements of a state: outcomes, data ports, transitions, data flows, scoped variables."""

from rafcon._lazy import submodules

__getattr__ = submodules(__name__)
