"""Access of scripts to the running machine: its status, and commands of the engine."""

from rafcon._lazy import submodules

__getattr__ = submodules(__name__)
