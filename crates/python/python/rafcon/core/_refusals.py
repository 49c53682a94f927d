"""Refusal of everything that would change the machine that runs: calls, assignments, constructors."""

from rafcon.core.custom_exceptions import MachineChangeNotSupported


def refuses(*names):
    """Class decorator: gives the class a method of each name that refuses."""

    def decorate(cls):
        for name in names:
            setattr(cls, name, _refusing_method(cls, name))
        return cls

    return decorate


def _refusing_method(cls, name):
    def method(self, *_arguments, **_named):
        raise MachineChangeNotSupported(f"{type(self).__name__}.{name}")

    method.__name__ = name
    method.__qualname__ = f"{cls.__qualname__}.{name}"
    method.__doc__ = "Changes the machine: refused with :class:`MachineChangeNotSupported`."
    return method


class fixed(property):  # noqa: N801, it is used as a decorator like `property`
    """A property that scripts can read; assigning to it would change the machine, and is refused."""

    def __set__(self, instance, value):
        raise MachineChangeNotSupported(f"{type(instance).__name__}.{self.fget.__name__} = …")

    def __delete__(self, instance):
        raise MachineChangeNotSupported(f"del {type(instance).__name__}.{self.fget.__name__}")


class NoConstructor:
    """Base of the classes whose objects are only made by the running machine."""

    def __init__(self, *_arguments, **_named):
        raise MachineChangeNotSupported(f"{type(self).__name__}(…)")
