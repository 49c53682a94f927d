"""Patterns for programs and plugins: observers and singletons."""

from rafcon._lazy import submodules

__getattr__ = submodules(__name__)
