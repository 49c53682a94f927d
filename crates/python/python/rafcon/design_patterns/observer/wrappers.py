"""Lists, sets and dictionaries that tell a model when they are changed."""

import functools

_LIST = "append extend insert pop remove clear reverse sort __delitem__ __setitem__ __iadd__ __imul__".split()
_SET = (
    "add remove discard pop clear update difference_update intersection_update symmetric_difference_update "
    "__iand__ __ior__ __isub__ __ixor__"
).split()
_DICT = "clear pop popitem setdefault update __delitem__ __setitem__".split()


class WrapperBase:
    """Something that belongs to models, each by the name of an attribute."""

    def __init__(self):
        self._models = []

    @property
    def models(self):
        """(model, name of the attribute), of all models."""
        return list(self.__dict__.get("_models", ()))

    def add_model(self, model, observable):
        """Tells this model, too, by this name."""
        self.__dict__.setdefault("_models", []).append((model, observable))

    def remove_model(self, model, observable):
        """Tells this model no longer."""
        self.__dict__["_models"] = [pair for pair in self.models if pair[0] is not model or pair[1] != observable]

    def notify_before(self, instance, name, args, kwargs):
        """Tells the models that a method is going to be called."""
        for model, observable in self.models:
            model.notify_before(observable, instance, name, args, kwargs)

    def notify_after(self, instance, name, value, args, kwargs):
        """Tells the models that a method was called."""
        for model, observable in self.models:
            model.notify_after(observable, instance, name, value, args, kwargs)


class Wrapper(WrapperBase):
    """Stands for an object; calls of some of its methods are announced."""

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
    """Stands for a collection."""

    def __len__(self):
        return len(self._obj)

    def __iter__(self):
        return iter(self._obj)

    def __contains__(self, item):
        return item in self._obj


def _announce(cls, names):
    """Python finds special methods at the class only."""
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
    """A list that tells when it is changed."""

    def __init__(self, obj):
        IterableWrapper.__init__(self, obj, _LIST)

    def __getitem__(self, index):
        return self._obj[index]


class SetWrapper(IterableWrapper):
    """A set that tells when it is changed."""

    def __init__(self, obj):
        IterableWrapper.__init__(self, obj, _SET)


class DictWrapper(IterableWrapper):
    """A dictionary that tells when it is changed."""

    def __init__(self, obj):
        IterableWrapper.__init__(self, obj, _DICT)

    def __getitem__(self, key):
        return self._obj[key]


_announce(ListWrapper, _LIST)
_announce(SetWrapper, _SET)
_announce(DictWrapper, _DICT)


def wrapped(value, model, observable):
    """A value as the attribute of a model: collections and signals tell the model from now on."""
    for kind, wrapper in ((list, ListWrapper), (set, SetWrapper), (dict, DictWrapper)):
        if type(value) is kind:
            value = wrapper(value)
    if isinstance(value, WrapperBase):
        value.add_model(model, observable)
    return value
