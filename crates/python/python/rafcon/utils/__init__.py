"""Helpers for scripts: logging, constants, nested dictionaries."""

from rafcon._lazy import submodules

__getattr__ = submodules(__name__)


class classproperty(property):
    """Property of a class: ``Class.name`` calls the function with the class."""

    def __get__(self, instance, owner=None):
        owner = type(instance) if owner is None else owner
        return self.fget.__get__(None, owner)() if isinstance(self.fget, classmethod) else self.fget(owner)
