"""The kinds of states; one module for each, as state machine files name them."""

from rafcon._lazy import submodules

__getattr__ = submodules(__name__)
