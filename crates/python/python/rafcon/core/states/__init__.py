"""Kinds of states, one module each, named as in state machine files."""

from rafcon._lazy import submodules

__getattr__ = submodules(__name__)
