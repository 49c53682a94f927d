"""The running machine as scripts see it: its status and the engine's commands."""

from rafcon._lazy import submodules

__getattr__ = submodules(__name__)
