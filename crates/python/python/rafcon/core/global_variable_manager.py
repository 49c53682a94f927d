"""Global variables: ``gvm`` in scripts. They outlive the runs of a machine, and end with the process."""

import copy
import os
import string
import threading
import types
from collections import deque

from rafcon._keeping import Ledger, Variable
from rafcon.core._waiting import Waiter
from rafcon.design_patterns.observer.observable import Observable
from rafcon.utils.log import get_logger

logger = get_logger(__name__)

_UNTYPED = type(None)
_KEY_LENGTH = 10
#: Immutable types, which are never copied.
_IMMUTABLE = frozenset(
    (int, str, float, bool, type(None), bytes, complex, type, types.FunctionType, types.BuiltinFunctionType)
)


class _Variable:
    """A variable: its value, whether that is the user's own object, its type, the key of who has locked it, and how the
    journal of the run keeps the value (None without a journal)."""

    __slots__ = ("value", "by_reference", "data_type", "access_key", "kept")

    def __init__(self):
        self.value = None
        self.by_reference = False
        self.data_type = _UNTYPED
        self.access_key = None
        self.kept = None


class GlobalVariableManager(Observable):
    """Named values that all states share.

    A value is kept as a deep copy, or as the object itself (``per_reference``). A locked variable is read and written
    by whoever has its access key; a call without a key waits for the end of the lock, first come, first served. Such a
    wait ends with :class:`~rafcon.core.custom_exceptions.StatePreempted` if the state of the script is preempted.
    """

    def __init__(self):
        # Guards the table and the variables. Never held during waits, copies, or requests to the running machine.
        self._lock = threading.RLock()
        self._variables = {}
        # Name of a locked variable to the waiting calls, in order of arrival.
        self._queues = {}
        self._ledger = Ledger()

    @staticmethod
    def instance(*arguments, **named):
        """The manager of this process, the one that scripts get as ``gvm``, which is there already: arguments mean nothing."""
        return global_variables

    # ---- reading and writing

    @Observable.observed
    def set_variable(self, key, value, per_reference=False, access_key=None, data_type=None):
        """Writes a variable; makes it if there is none.

        ``key`` is turned into a ``str``. ``data_type`` declares its type; without one it keeps the type that it has.
        Waits while the variable is locked, unless the ``access_key`` is given. Raises ``TypeError`` for a value that is
        not of the type, ``RuntimeError`` for a wrong key, and what ``copy.deepcopy`` raises; nothing is changed then.
        """
        key = str(key)
        if data_type is not None and not isinstance(data_type, type):
            raise TypeError(f"data_type must be a type, not {data_type!r}")
        own = value if per_reference else _copied(value)
        kept = self._ledger.keep(own, bool(per_reference), data_type or self.get_data_type(key) or _UNTYPED)

        def write(variable):
            declared = data_type or (_UNTYPED if variable is None else variable.data_type)
            self.check_value_and_type(own, declared)
            if variable is None:
                variable = self._variables.setdefault(key, _Variable())
            variable.value, variable.by_reference, variable.data_type = own, bool(per_reference), declared
            variable.kept = kept
            self._ledger.note(key, kept)

        self._when_allowed(key, access_key, write)
        self._ledger.write()

    def get_variable(self, key, per_reference=None, access_key=None, default=None):
        """The value of a variable, or ``default`` if there is none.

        A deep copy if it is kept as a copy, the object itself if it is kept by reference; ``per_reference=False`` asks
        for a copy of that too. Waits while the variable is locked, unless the ``access_key`` is given. Raises
        ``RuntimeError`` for a wrong key, and for ``per_reference=True`` on a variable that is kept as a copy.
        """
        key = str(key)
        found = self._when_allowed(key, access_key, _content)
        if found is None:
            return default
        value, by_reference = found
        if by_reference:
            return _copied(value) if per_reference is False else value
        if per_reference:
            raise RuntimeError(f"the global variable `{key}` is kept as a copy; it cannot be had by reference")
        return _copied(value)

    def set_locked_variable(self, key, access_key, value):
        """Writes a variable that the caller has locked."""
        return self.set_variable(key, value, per_reference=False, access_key=access_key)

    def get_locked_variable(self, key, access_key):
        """The value of a variable that the caller has locked."""
        return self.get_variable(key, per_reference=False, access_key=access_key)

    def get_representation(self, key):
        """The object that is kept, locked or not, never a copy; None if there is no such variable."""
        variable = self._variables.get(str(key))
        return None if variable is None else variable.value

    # ---- locks

    @Observable.observed
    def lock_variable(self, key, block=False):
        """Locks a variable and returns the access key (``str``).

        If it is locked already: waits with ``block``, else logs a warning and returns False. False, too, with an
        error in the log, if there is no such variable.
        """
        key = str(key)
        access_key = self._when_allowed(key, None, _locked) if block else self._lock_now(key)
        if access_key is None:
            logger.error("Global variable '%s' does not exist, so it cannot be locked", key)
        elif access_key is False:
            logger.warning("Global variable '%s' is locked already", key)
        return access_key or False

    def _lock_now(self, key):
        with self._lock:
            variable = self._variables.get(key)
            if variable is not None and variable.access_key is not None:
                return False
            return _locked(variable)

    @Observable.observed
    def unlock_variable(self, key, access_key, force=False):
        """Ends a lock and serves those who wait; True if it was locked.

        ``force`` needs no key. Raises ``KeyError`` if there is no such variable, ``RuntimeError`` for a wrong key.
        """
        key = str(key)
        with self._lock:
            variable = self._variables.get(key)
            if variable is None:
                raise KeyError(f"there is no global variable `{key}`")
            locked = variable.access_key is not None
            if locked:
                if not force:
                    _check_key(key, variable, access_key)
                variable.access_key = None
                self._serve(key)
        if not locked:
            logger.error("Global variable '%s' is not locked, so it cannot be unlocked", key)
        return locked

    def is_locked(self, key):
        """Whether the variable is locked; False if there is none."""
        variable = self._variables.get(str(key))
        return variable is not None and variable.access_key is not None

    # ---- the table

    @Observable.observed
    def delete_variable(self, key):
        """Removes a variable and its type; ``AttributeError`` if there is none, ``RuntimeError`` if it is locked."""
        key = str(key)
        with self._lock:
            variable = self._variables.get(key)
            if variable is None:
                raise AttributeError(f"there is no global variable `{key}`")
            if variable.access_key is not None:
                raise RuntimeError(f"the global variable `{key}` is locked, so it cannot be deleted")
            del self._variables[key]
            self._ledger.note(key, None)
        self._ledger.write()

    def reset(self):
        """Removes all variables, locked ones too; who waits for one finds that it is gone."""
        with self._lock:
            for key in self._variables:
                self._ledger.note(key, None)
            self._variables = {}
            for key in list(self._queues):
                self._serve(key)
        self._ledger.write()

    destroy_all_variables = reset

    def variable_exist(self, key):
        """Whether there is such a variable."""
        return str(key) in self._variables

    variable_exists = variable_exist

    def variable_can_be_referenced(self, key):
        """Whether there is such a variable and it is kept by reference."""
        variable = self._variables.get(str(key))
        return variable is not None and variable.by_reference

    def data_type_exist(self, key):
        """Whether there is such a variable, so that it has a type."""
        return self.variable_exist(key)

    def get_data_type(self, key):
        """The declared type of a variable, ``NoneType`` if none was declared; None if there is no such variable."""
        variable = self._variables.get(str(key))
        return None if variable is None else variable.data_type

    def get_all_keys(self):
        """The names of all variables, in the order in which they were made."""
        return list(self._variables)

    def get_all_keys_starting_with(self, start_key):
        """The names that begin with a text."""
        return [key for key in self._variables.copy() if key.startswith(start_key)]

    @staticmethod
    def check_value_and_type(value, data_type):
        """Raises ``TypeError`` unless the value may be kept in a variable of this type.

        None always may, and everything if no type was declared. Else the value is of the type or of a subclass; an
        ``int`` is a ``float`` too. Because machines rely on it, a value of a base class is let through as well (an
        ``int`` in a ``bool`` variable).
        """
        if value is None or data_type is _UNTYPED or isinstance(value, data_type):
            return
        given = type(value)
        if (data_type is float and given is int) or (given is not object and issubclass(data_type, given)):
            return
        raise TypeError(
            f"a value of type {given.__name__} cannot be kept in a global variable of type {data_type.__name__}"
        )

    # ---- for the runner

    def _resolve(self, name):
        """(found, value, how the journal keeps it) for a port default `$name`: never waits, for a locked variable neither.

        The engine is locked meanwhile, so no code of the user runs, and nothing is copied: the value is the variable's own,
        which nobody else changes, and a script gets a copy of its inputs anyway.
        """
        with self._lock:
            variable = self._variables.get(name)
            found = _content(variable)
            kept = None if variable is None else variable.kept
        if found is None:
            return False, None, None
        return True, found[0], kept

    def _restore(self, name, value):
        """Puts a variable back as the journal of the run had it."""
        variable = _Variable()
        if isinstance(value, Variable):
            variable.value, variable.by_reference, variable.data_type = value.value, value.by_reference, value.data_type
        else:
            variable.value = value
        variable.kept = self._ledger.keep(variable.value, variable.by_reference, variable.data_type)
        self._ledger.forget(name)
        with self._lock:
            self._variables[name] = variable

    def _keep_in(self, journal):
        """From now on each change goes into the journal of the run; what is there already does as the run begins."""
        self._ledger = Ledger(journal)
        for name, variable in self._variables.items():
            variable.kept = self._ledger.keep(variable.value, variable.by_reference, variable.data_type)
            self._ledger.note(name, variable.kept)

    def _note_all(self):
        """The run begins: the variables that were there before it, and were not put back by it, go into its journal."""
        self._ledger.write()

    def _values(self):
        """Name to value, the kept objects themselves."""
        with self._lock:
            return {key: variable.value for key, variable in self._variables.items()}

    def _after_fork_in_child(self):
        """The lock may have been held by a thread that does not exist in the child; the journal is the parent's."""
        self._lock = threading.RLock()
        self._ledger = Ledger()

    # ---- waiting

    def _when_allowed(self, key, access_key, act):
        """``act(variable)`` as soon as the variable is not locked, or at once with its key."""
        with self._lock:
            variable = self._variables.get(key)
            if variable is None or variable.access_key is None:
                return act(variable)
            if access_key is not None:
                _check_key(key, variable, access_key)
                return act(variable)
        return self._wait(key, Waiter(act))

    def _wait(self, key, waiter):
        with self._lock:
            self._queues.setdefault(key, deque()).append(waiter)
            self._serve(key)
        if not waiter.sleep() and self._give_up(key, waiter):
            raise waiter.preemption(key)
        return waiter.result()

    def _give_up(self, key, waiter):
        """Takes a call out of the queue; False if its turn has come meanwhile."""
        with self._lock:
            if not waiter.done:
                self._queues[key].remove(waiter)
        return not waiter.done

    def _serve(self, key):
        """Carries out the waiting calls in turn, until one of them locks the variable (again)."""
        queue = self._queues.get(key, ())
        while queue:
            variable = self._variables.get(key)
            if variable is not None and variable.access_key is not None:
                return
            queue.popleft().finish(variable)
        self._queues.pop(key, None)


def _content(variable):
    return None if variable is None else (variable.value, variable.by_reference)


def _locked(variable):
    """Locks a free variable; its access key, or None if there is no variable."""
    if variable is None:
        return None
    variable.access_key = "".join(string.ascii_uppercase[byte % 26] for byte in os.urandom(_KEY_LENGTH))
    return variable.access_key


def _check_key(key, variable, access_key):
    if access_key != variable.access_key:
        raise RuntimeError(f"wrong access key for the locked global variable `{key}`")


def _copied(value):
    return value if type(value) in _IMMUTABLE else copy.deepcopy(value)


#: The variables of this process.
global_variables = GlobalVariableManager()
