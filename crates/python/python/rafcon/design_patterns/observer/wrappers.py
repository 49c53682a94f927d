"""Lists, sets and dictionaries that notify a model of changes."""

import functools

_LIST = "append extend insert pop remove clear reverse sort __delitem__ __setitem__ __iadd__ __imul__".split()
_SET = (
    "add remove discard pop clear update difference_update intersection_update symmetric_difference_update "
    "__iand__ __ior__ __isub__ __ixor__"
).split()
_DICT = "clear pop popitem setdefault update __delitem__ __setitem__".split()


class WrapperBase:
    """Base of values that belong to models, each by the name of an attribute."""

    def __init__(self):
        self._models = []

    @property
    def models(self):
        """Pairs of model and attribute name."""
        return list(self.__dict__.get("_models", ()))

    def add_model(self, model, observable):
        """Notify this model too, with this name of the attribute."""
        self.__dict__.setdefault("_models", []).append((model, observable))

    def remove_model(self, model, observable):
        """Stop notifying this model."""
        self.__dict__["_models"] = [pair for pair in self.models if pair[0] is not model or pair[1] != observable]

    def notify_before(self, instance, name, args, kwargs):
        """Notify the models before a method is called."""
        for model, observable in self.models:
            model.notify_before(observable, instance, name, args, kwargs)

    def notify_after(self, instance, name, value, args, kwargs):
        """Notify the models after a method was called."""
        for model, observable in self.models:
            model.notify_after(observable, instance, name, value, args, kwargs)


class Wrapper(WrapperBase):
    """Proxy of an object that announces calls of some of its methods."""

    def __init__(self, obj, methods):
        WrapperBase.__init__(self)
        self._obj = obj
        self._methods = frozenset(methods)

    def __getattr__(self, name):
        if name.startswith("__") or "_obj" not in self.__dict__:
            raise AttributeError(name)
        found = getattr(self._obj, name)
        return functools.partial(self._call, name) if name in self._methods else found

    def _call(self, name, *args, **kwargs):
        self.notify_before(self._obj, name, args, kwargs)
        value = getattr(self._obj, name)(*args, **kwargs)
        self.notify_after(self._obj, name, value, args, kwargs)
        return self if name.startswith("__i") else value

    def __repr__(self):
        return repr(self._obj)

    def __eq__(self, other):
        return self._obj == (other._obj if isinstance(other, Wrapper) else other)

    __hash__ = None


class IterableWrapper(Wrapper):
    """Proxy of a collection."""

    def __len__(self):
        return len(self._obj)

    def __iter__(self):
        return iter(self._obj)

    def __contains__(self, item):
        return item in self._obj


def _announce(cls, names):
    """Define special methods at the class: Python ignores those of objects."""
    for name in names:
        if name.startswith("__"):
            setattr(cls, name, _special(name))
    return cls


def _special(name):
    def call(self, *args):
        return self._call(name, *args)

    call.__name__ = name
    return call


class ListWrapper(IterableWrapper):
    """List that notifies its models of changes."""

    def __init__(self, obj):
        IterableWrapper.__init__(self, obj, _LIST)

    def __getitem__(self, index):
        return self._obj[index]


class SetWrapper(IterableWrapper):
    """Set that notifies its models of changes."""

    def __init__(self, obj):
        IterableWrapper.__init__(self, obj, _SET)


class DictWrapper(IterableWrapper):
    """Dictionary that notifies its models of changes."""

    def __init__(self, obj):
        IterableWrapper.__init__(self, obj, _DICT)

    def __getitem__(self, key):
        return self._obj[key]


_announce(ListWrapper, _LIST)
_announce(SetWrapper, _SET)
_announce(DictWrapper, _DICT)


def wrapped(value, model, observable):
    """Wrap a value as an attribute of a model; collections and signals notify the model."""
    for kind, wrapper in ((list, ListWrapper), (set, SetWrapper), (dict, DictWrapper)):
        if type(value) is kind:
            value = wrapper(value)
    if isinstance(value, WrapperBase):
        value.add_model(model, observable)
    return value
