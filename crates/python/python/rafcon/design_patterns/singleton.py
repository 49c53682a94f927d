"""Classes with one object per process."""


class Singleton:
    """Decorator of a class: ``Class.instance()`` returns its object, a call is a ``TypeError``."""

    def __init__(self, cls):
        self._cls = cls
        self._instance = None
        self.__doc__ = cls.__doc__
        self.__name__ = cls.__name__
        self.__module__ = cls.__module__

    def instance(self, *args, **kwargs):
        """Only object of the class; the first call creates it, with these arguments."""
        if self._instance is None:
            self._instance = self._cls(*args, **kwargs)
        return self._instance

    def __call__(self):
        raise TypeError(f"there is one {self.__name__} in a process; get it by `{self.__name__}.instance()`")

    def __instancecheck__(self, instance):
        return isinstance(instance, self._cls)
