"""State machines of this process: the running one, or those that a program has built or loaded."""

import os

from rafcon import _objects
from rafcon.core._refusals import hosted
from rafcon.design_patterns.observer.observable import Observable


class StateMachineManager(Observable):
    """Registry of state machines by id."""

    def __init__(self):
        self._machines = {}
        self._active_id = None

    @staticmethod
    def instance(*arguments, **named):
        """Manager of this process; arguments have no effect."""
        from rafcon.core.singleton import state_machine_manager

        return state_machine_manager

    @property
    def state_machines(self):
        """Id to :class:`~rafcon.core.state_machine.StateMachine`."""
        if not _objects.is_host():
            return dict(self._machines)
        running = self.get_active_state_machine()
        return {} if running is None else {running.state_machine_id: running}

    @property
    def active_state_machine_id(self):
        """Id of the active state machine, which runs or is run next, or None."""
        machine = self.get_active_state_machine()
        return None if machine is None else machine.state_machine_id

    @active_state_machine_id.setter
    @Observable.observed
    def active_state_machine_id(self, state_machine_id):
        hosted("StateMachineManager.active_state_machine_id = …")
        if state_machine_id is not None and state_machine_id not in self._machines:
            raise AttributeError(f"there is no state machine with the id {state_machine_id}")
        self._active_id = state_machine_id

    @Observable.observed
    def add_state_machine(self, state_machine):
        """Register a state machine and return its id.

        Raises ``AttributeError`` if a state machine of its folder is already registered.
        """
        from rafcon.core.state_machine import StateMachine

        hosted("StateMachineManager.add_state_machine")
        if not isinstance(state_machine, StateMachine):
            raise AttributeError(f"a StateMachine is expected, not {type(state_machine).__name__}")
        path = state_machine.file_system_path
        if path is not None and self.is_state_machine_open(path):
            raise AttributeError(f"the state machine in {path} is open already")
        self._machines[state_machine.state_machine_id] = state_machine
        return state_machine.state_machine_id

    @Observable.observed
    def remove_state_machine(self, state_machine_id):
        """Unregister a state machine and return it; None if there is none with this id."""
        hosted("StateMachineManager.remove_state_machine")
        if state_machine_id == self._active_id:
            self._active_id = None
        return self._machines.pop(state_machine_id, None)

    def remove_state_machine_by_path(self, path):
        """Unregister the state machine of a folder and return it; None if there is none."""
        machine = self.get_open_state_machine_of_file_system_path(path)
        return None if machine is None else self.remove_state_machine(machine.state_machine_id)

    def delete_all_state_machines(self):
        """Unregister all state machines except the active one."""
        for state_machine_id in [key for key in self._machines if key != self._active_id]:
            self.remove_state_machine(state_machine_id)

    def open_state_machines(self, state_machine_path_by_sm_id):
        """Load and register state machines, id to folder."""
        from rafcon.core.storage import storage

        for state_machine_id, path in state_machine_path_by_sm_id.items():
            self.add_state_machine(storage.load_state_machine_from_path(path, state_machine_id))

    def get_active_state_machine(self):
        """Active state machine, which runs or is run next, or None."""
        return _objects.machine_or_none() if _objects.is_host() else self._machines.get(self._active_id)

    def get_state_machine(self, state_machine_id):
        """State machine with this id, or None."""
        return self.state_machines.get(state_machine_id)

    def is_state_machine_open(self, file_system_path):
        """True if the state machine of a folder is registered."""
        return self.get_open_state_machine_of_file_system_path(file_system_path) is not None

    def get_open_state_machine_of_file_system_path(self, file_system_path):
        """State machine of a folder if it is registered, else None."""
        wanted = os.path.realpath(file_system_path)
        for machine in self.state_machines.values():
            if machine.file_system_path is not None and os.path.realpath(machine.file_system_path) == wanted:
                return machine
        return None

    def get_sm_id_for_root_state_id(self, root_state_id):
        """Id of the first state machine whose root state has this id, or None."""
        machines = self.state_machines.items()
        return next((key for key, machine in machines if machine.root_state.state_id == root_state_id), None)

    def has_dirty_state_machine(self):
        """True if a state machine has unsaved changes."""
        return any(machine.marked_dirty for machine in self.state_machines.values())
