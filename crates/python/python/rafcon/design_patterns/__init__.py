"""Small patterns that programs and plugins build on: observers and singletons."""

from rafcon._lazy import submodules

__getattr__ = submodules(__name__)
