"""Exceptions that scripts may receive."""


class LibraryNotFoundException(Exception):
    """A library is not below any of the library roots."""


class LibraryNotFoundSkipException(Exception):
    """A library is missing and was to be skipped."""


class RecoveryModeException(ValueError):
    """An element is invalid, and the machine is loaded nevertheless.

    ``do_delete_item`` is True if the element is to be skipped.
    """

    def __init__(self, message, do_delete_item=False):
        ValueError.__init__(self, message)
        self.do_delete_item = do_delete_item


class MachineChangeNotSupported(RuntimeError):
    """A script requested something that the process of a running machine does not do.

    Nothing has changed.
    """

    def __init__(self, call):
        RuntimeError.__init__(
            self,
            f"`{call}` is not possible in the process of a running state machine: it runs this one machine, and what "
            "belongs to its files is changed from outside. Nothing was changed.",
        )
        self.call = call


class MachineChangeRefused(RuntimeError):
    """A change would remove something that the running machine uses. Nothing has changed."""


class CommandNotSupported(RuntimeError):
    """A script called a function of the engine that is not available in its own machine."""

    def __init__(self, call):
        RuntimeError.__init__(self, f"`{call}` is not for scripts of the machine that runs; nothing was done")
        self.call = call


class StatePreempted(BaseException):
    """Ends a script that waits for a locked global variable when its state is preempted.

    It is raised once in a run of a state, and only if the script has not yet seen the preemption
    (from ``self.preempted`` or the result of a wait). Later calls, in ``finally`` or ``except``,
    wait as usual. The state leaves by *preempted*. The class is not a subclass of ``Exception``, so
    that ``except Exception`` does not catch it.
    """
