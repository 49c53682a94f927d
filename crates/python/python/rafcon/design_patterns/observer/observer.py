"""Models that announce changes, and observers of these models."""

_KINDS = ("assign", "before", "after", "signal")


class NotifyInfo(dict):
    """Notification: its entries are also attributes; ``info.assign`` and so on give its kind."""

    def __init__(self, flag, *args, **kwargs):
        dict.__init__(self, *args, **kwargs)
        self[flag] = True

    def __getattr__(self, name):
        if name in self:
            return self[name]
        if name in _KINDS:
            return False
        raise AttributeError(name)

    __setattr__ = dict.__setitem__


class Observer:
    """Observes models, with methods decorated by :meth:`observe`.

    A class with ``__observables__`` and
    :class:`~rafcon.design_patterns.observer.observable.ObservableMetaclass` is a model itself. A
    method of the form ``name(self, model, attribute, info)`` is called with a :class:`NotifyInfo`.
    """

    def __init__(self, model=None):
        self._registered = []
        self._methods = {}
        for name in dir(type(self)):
            for observable, kinds in getattr(getattr(type(self), name, None), "_observes", ()):
                self._methods.setdefault(observable, []).append((name, kinds))
        if model is not None:
            self.observe_model(model)

    @classmethod
    def observe(cls, observable, assign=False, before=False, after=False, signal=False):
        """Decorator: notify the method of these kinds of events of an attribute."""
        kinds = {kind for kind, wanted in zip(_KINDS, (assign, before, after, signal)) if wanted}

        def mark(method):
            method._observes = (*getattr(method, "_observes", ()), (observable, kinds))
            return method

        return mark

    @property
    def observable_to_methods(self):
        """Name of an attribute to the names of the methods that observe it."""
        return {observable: {name for name, _kinds in methods} for observable, methods in self._methods.items()}

    def observe_model(self, model):
        """Observe a model from now on."""
        model.register_observer(self)

    def relieve_model(self, model):
        """Stop observing a model."""
        model.unregister_observer(self)

    def get_observables(self):
        """Names of the observable attributes of this model."""
        return {name for cls in type(self).__mro__ for name in vars(cls).get("__observables__", ())}

    def register_observer(self, observer):
        """Notify an observer from now on."""
        if all(known is not observer for known in self._registered):
            self._registered.append(observer)

    def unregister_observer(self, observer):
        """Stop notifying an observer."""
        self._registered = [known for known in self._registered if known is not observer]

    def notify_observer(self, observer, method, *args, **kwargs):
        """Call one method of an observer; a model may override this."""
        return method(*args, **kwargs)

    def notify_assign(self, observable, old_value, new_value):
        """Notify observers of an assignment to an attribute."""
        self._notify("assign", observable, old=old_value, new=new_value)

    def notify_before(self, observable, instance, method_name, args, kwargs):
        """Notify observers before a method of an attribute is called."""
        self._notify("before", observable, instance=instance, method_name=method_name, args=args, kwargs=kwargs)

    def notify_after(self, observable, instance, method_name, result, args, kwargs):
        """Notify observers after a method of an attribute was called."""
        call = {"instance": instance, "method_name": method_name, "args": args, "kwargs": kwargs}
        self._notify("after", observable, result=result, **call)

    def notify_signal(self, observable, args):
        """Notify observers of a signal."""
        self._notify("signal", observable, arg=args)

    def _notify(self, kind, observable, **about):
        for observer in list(self.__dict__.get("_registered", ())):
            for name, kinds in observer._methods.get(observable, ()):
                if kind in kinds:
                    info = NotifyInfo(kind, model=self, prop_name=observable, **about)
                    self.notify_observer(observer, getattr(observer, name), self, observable, info)
