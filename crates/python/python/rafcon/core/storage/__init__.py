"""Storage of state machines in files."""

from rafcon._lazy import submodules

__getattr__ = submodules(__name__)
