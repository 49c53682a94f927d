"""Global variables: ``gvm`` in scripts. They outlive runs of a machine and end with the process."""

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
    """Variable: its value, type, access key while it is locked, and form in the journal.

    ``by_reference`` is True if the value is the user's own object. ``kept`` is None without a
    journal.
    """

    __slots__ = ("value", "by_reference", "data_type", "access_key", "kept")

    def __init__(self):
        self.value = None
        self.by_reference = False
        self.data_type = _UNTYPED
        self.access_key = None
        self.kept = None


class GlobalVariableManager(Observable):
    """Named values that all states share.

    A value is stored as a deep copy, or as the object itself (``per_reference``). A locked variable
    can only be read and written with its access key. A call without the key waits until the lock
    ends; calls are served in the order of their arrival. A preemption of the script's state ends
    such a wait with :class:`~rafcon.core.custom_exceptions.StatePreempted`.
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
        """Manager of this process, which scripts receive as ``gvm``; arguments have no effect."""
        return global_variables

    # ---- reading and writing

    @Observable.observed
    def set_variable(self, key, value, per_reference=False, access_key=None, data_type=None):
        """Set a variable, and create it if it is missing.

        ``key`` is converted to ``str``. ``data_type`` declares the type of the variable; without it
        the type stays. Waits while the variable is locked, unless the ``access_key`` is given.
        Raises ``TypeError`` for a value of another type, ``RuntimeError`` for a wrong key, and any
        exception of ``copy.deepcopy``. The variable is unchanged after an error.
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
        """Value of a variable, or ``default`` if there is no such variable.

        Returns a deep copy of a variable that is stored as a copy, and the object itself of one
        that is stored by reference, or a copy with ``per_reference=False``. Waits while the
        variable is locked, unless the ``access_key`` is given. Raises ``RuntimeError`` for a wrong
        key, and for ``per_reference=True`` on a variable that is stored as a copy.
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
        """Set a variable that the caller has locked."""
        return self.set_variable(key, value, per_reference=False, access_key=access_key)

    def get_locked_variable(self, key, access_key):
        """Value of a variable that the caller has locked."""
        return self.get_variable(key, per_reference=False, access_key=access_key)

    def get_representation(self, key):
        """Stored object itself, locked or not; None if there is no such variable."""
        variable = self._variables.get(str(key))
        return None if variable is None else variable.value

    # ---- locks

    @Observable.observed
    def lock_variable(self, key, block=False):
        """Lock a variable and return the access key (``str``).

        If it is locked already, waits with ``block``, else logs a warning and returns False. If
        there is no such variable, logs an error and returns False.
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
        """Unlock a variable and serve waiting calls; True if it was locked.

        ``force`` needs no key. Raises ``KeyError`` if there is no such variable, ``RuntimeError``
        for a wrong key.
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
        """True if the variable is locked; False if there is no such variable."""
        variable = self._variables.get(str(key))
        return variable is not None and variable.access_key is not None

    # ---- the table

    @Observable.observed
    def delete_variable(self, key):
        """Remove a variable and its type.

        Raises ``AttributeError`` if there is no such variable, ``RuntimeError`` if it is locked.
        """
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
        """Remove all variables, also locked ones; waiting calls find their variable missing."""
        with self._lock:
            for key in self._variables:
                self._ledger.note(key, None)
            self._variables = {}
            for key in list(self._queues):
                self._serve(key)
        self._ledger.write()

    destroy_all_variables = reset

    def variable_exist(self, key):
        """True if there is such a variable."""
        return str(key) in self._variables

    variable_exists = variable_exist

    def variable_can_be_referenced(self, key):
        """True if there is such a variable and it is stored by reference."""
        variable = self._variables.get(str(key))
        return variable is not None and variable.by_reference

    def data_type_exist(self, key):
        """True if there is such a variable: each one has a type."""
        return self.variable_exist(key)

    def get_data_type(self, key):
        """Declared type of a variable.

        ``NoneType`` if no type was declared, None if there is no such variable.
        """
        variable = self._variables.get(str(key))
        return None if variable is None else variable.data_type

    def get_all_keys(self):
        """Names of all variables, in the order of their creation."""
        return list(self._variables)

    def get_all_keys_starting_with(self, start_key):
        """Names that begin with a text."""
        return [key for key in self._variables.copy() if key.startswith(start_key)]

    @staticmethod
    def check_value_and_type(value, data_type):
        """Raise ``TypeError`` unless the value may be stored in a variable of this type.

        None is always accepted, and any value if no type was declared. Otherwise the value must be
        of the type or a subclass; an ``int`` is accepted as a ``float``. Because machines rely on
        it, a value of a base class is accepted too (an ``int`` in a ``bool`` variable).
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
        """Resolve a port default ``$name`` to (found, value, the value's form in the journal).

        Never waits, not even for a locked variable. The engine is locked meanwhile, so no code of
        the user runs, and the value is not copied: nobody else changes the variable's own value,
        and a script receives a copy of its inputs anyway.
        """
        with self._lock:
            variable = self._variables.get(name)
            found = _content(variable)
            kept = None if variable is None else variable.kept
        if found is None:
            return False, None, None
        return True, found[0], kept

    def _restore(self, name, value):
        """Restore a variable from the journal of the run."""
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
        """Write each change to the journal from now on, and queue the current variables for it."""
        self._ledger = Ledger(journal)
        for name, variable in self._variables.items():
            variable.kept = self._ledger.keep(variable.value, variable.by_reference, variable.data_type)
            self._ledger.note(name, variable.kept)

    def _note_all(self):
        """Write the queued variables to the journal, at the beginning of the run."""
        self._ledger.write()

    def _values(self):
        """Stored objects themselves, by name."""
        with self._lock:
            return {key: variable.value for key, variable in self._variables.items()}

    def _after_fork_in_child(self):
        """Replace the lock, which a thread of the parent may hold; drop the parent's journal."""
        self._lock = threading.RLock()
        self._ledger = Ledger()

    # ---- waiting

    def _when_allowed(self, key, access_key, act):
        """Run ``act(variable)`` once the variable is unlocked, or at once with its key."""
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
        """Remove a call from the queue; False if it has been served meanwhile."""
        with self._lock:
            if not waiter.done:
                self._queues[key].remove(waiter)
        return not waiter.done

    def _serve(self, key):
        """Run the waiting calls in order, until one of them locks the variable (again)."""
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
    """Lock a free variable; return its access key, or None if there is no variable."""
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
