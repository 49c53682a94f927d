"""Parts of a state machine: states, their elements, the running objects and the variables."""

from rafcon._lazy import submodules

__getattr__ = submodules(__name__)
