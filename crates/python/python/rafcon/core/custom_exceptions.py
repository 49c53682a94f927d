"""The exceptions that scripts may meet."""


class LibraryNotFoundException(Exception):
    """A library is not below any of the library roots."""


class LibraryNotFoundSkipException(Exception):
    """A library is missing and was chosen to be left out."""


class RecoveryModeException(ValueError):
    """An element is not valid, and the machine is loaded all the same.

    ``do_delete_item`` says whether the element is to be left out.
    """

    def __init__(self, message, do_delete_item=False):
        ValueError.__init__(self, message)
        self.do_delete_item = do_delete_item


class MachineChangeNotSupported(RuntimeError):
    """A script asked for something that the process of a running machine does not do. Nothing has changed."""

    def __init__(self, call):
        RuntimeError.__init__(
            self,
            f"`{call}` is not possible in the process of a running state machine: it runs this one machine, and what "
            "belongs to its files is changed from outside. Nothing was changed.",
        )
        self.call = call


class MachineChangeRefused(RuntimeError):
    """A change of the running machine would take something away that is in use. Nothing has changed."""


class CommandNotSupported(RuntimeError):
    """A script called something of the engine that makes no sense in the machine that it is part of."""

    def __init__(self, call):
        RuntimeError.__init__(self, f"`{call}` is not for scripts of the machine that runs; nothing was done")
        self.call = call


class StatePreempted(BaseException):
    """Ends a script that was blocked on a locked global variable when its state was preempted.

    It is raised once in a run of a state, and only if the script has not yet seen that it is preempted
    (``self.preempted`` or a wait said so). Calls made afterwards, in ``finally`` or ``except``, wait as usual. The
    state leaves by *preempted*. It is no ``Exception``, so that ``except Exception`` lets it pass.
    """
