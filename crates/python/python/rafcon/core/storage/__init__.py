"""Names of the files of a state machine."""

from rafcon._lazy import submodules

__getattr__ = submodules(__name__)
