"""Objects whose methods and properties can be observed."""

import copy
import functools

from rafcon.design_patterns.observer.wrappers import WrapperBase, wrapped

#: The attribute of a class with the names that its models announce.
OBSERVABLES = "__observables__"


class Observable(WrapperBase):
    """Base of classes with methods and setters decorated by :meth:`observed`.

    See :meth:`add_observer`.
    """

    def __init__(self):
        WrapperBase.__init__(self)

    @staticmethod
    def observed(function):
        """Decorator of a method or property setter: call its observers before and after it."""

        @functools.wraps(function)
        def around(self, *args, **kwargs):
            observers = self.__dict__.get("_observers")
            if not observers or function.__name__ not in observers:
                return function(self, *args, **kwargs)
            return self._call_observed(function.__name__, function, args, kwargs)

        return around

    def add_observer(self, observer, key, notify_before_function=None, notify_after_function=None):
        """Call functions around each call of the method, or assignment to the property, ``key``.

        ``notify_before_function(observable, args)`` is called before it, and
        ``notify_after_function(observable, result, args)`` after it, with the exception as
        ``result`` if it failed. ``args`` begin with the observed object. Both are called on the
        thread of the call. Another pair of one ``observer`` replaces its first.
        """
        observers = self.__dict__.setdefault("_observers", {}).setdefault(key, {})
        observers[id(observer)] = observer, notify_before_function, notify_after_function

    def _call_observed(self, name, function, args, kwargs):
        every = (self, *args, *kwargs.values())
        pairs = list(self._observers[name].values())
        for _observer, before, _after in pairs:
            if before is not None:
                before(self, every)
        try:
            result = function(self, *args, **kwargs)
        except Exception as error:
            _notify_after(self, pairs, error, every)
            raise
        _notify_after(self, pairs, result, every)
        return result


def _notify_after(observable, pairs, result, args):
    for _observer, _before, after in pairs:
        if after is not None:
            after(observable, result, args)


class Signal(Observable):
    """Signal that a model sends with :meth:`emit`."""

    def emit(self, args=None):
        """Notify the observers of the model."""
        for model, name in self.models:
            model.notify_signal(name, args)


class ObservableMetaclass(type):
    """Metaclass of models, which notify observers of changes of their ``__observables__``."""

    def __init__(cls, name, bases, members):
        type.__init__(cls, name, bases, members)
        for observable in members.get(OBSERVABLES, ()):
            setattr(cls, observable, _announced(observable, members.get(observable)))

    @classmethod
    def add(cls, metaclass):
        """Decorator of a class: replace it by a subclass with this metaclass."""

        def remake(decorated):
            names = decorated.__dict__.get(OBSERVABLES, ())
            members = {name: getattr(decorated, name, None) for name in names}
            about = {name: getattr(decorated, name) for name in ("__module__", "__qualname__", "__doc__")}
            return metaclass(decorated.__name__, (decorated,), {OBSERVABLES: names, **members, **about})

        return remake


def _announced(name, first):
    attribute = f"_observable_{name}"

    def read(model):
        if attribute not in model.__dict__:
            model.__dict__[attribute] = wrapped(_copied(first), model, name)
        return model.__dict__[attribute]

    def write(model, value):
        old = read(model)
        if isinstance(old, WrapperBase):
            old.remove_model(model, name)
        model.__dict__[attribute] = wrapped(value, model, name)
        model.notify_assign(name, old, value)

    return property(read, write)


def _copied(first):
    """Copy a class attribute as a model's initial value, without the models of the original."""
    found = copy.copy(first) if isinstance(first, (list, set, dict, WrapperBase)) else first
    if isinstance(found, WrapperBase):
        found._models = []
    return found
