"""The state machines of this process: the one that runs, or those that a program has built and loaded."""

import os

from rafcon import _objects
from rafcon.core._refusals import hosted
from rafcon.design_patterns.observer.observable import Observable


class StateMachineManager(Observable):
    """Knows the state machines by their ids."""

    def __init__(self):
        self._machines = {}
        self._active_id = None

    @staticmethod
    def instance(*arguments, **named):
        """The manager of this process, which is there already: arguments mean nothing."""
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
        """The id of the state machine that runs, or None."""
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
        """Makes a state machine known and returns its id; ``AttributeError`` if one of the same folder is there."""
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
        """Forgets a state machine and returns it; None, if there is none of this id."""
        hosted("StateMachineManager.remove_state_machine")
        if state_machine_id == self._active_id:
            self._active_id = None
        return self._machines.pop(state_machine_id, None)

    def remove_state_machine_by_path(self, path):
        """Forgets the state machine of a folder and returns it."""
        machine = self.get_open_state_machine_of_file_system_path(path)
        return None if machine is None else self.remove_state_machine(machine.state_machine_id)

    def delete_all_state_machines(self):
        """Forgets all state machines but the active one, which runs."""
        for state_machine_id in [key for key in self._machines if key != self._active_id]:
            self.remove_state_machine(state_machine_id)

    def open_state_machines(self, state_machine_path_by_sm_id):
        """Loads state machines, id to folder."""
        from rafcon.core.storage import storage

        for state_machine_id, path in state_machine_path_by_sm_id.items():
            self.add_state_machine(storage.load_state_machine_from_path(path, state_machine_id))

    def get_active_state_machine(self):
        """The state machine that runs, or None."""
        return _objects.machine_or_none() if _objects.is_host() else self._machines.get(self._active_id)

    def get_state_machine(self, state_machine_id):
        """The state machine of this id, or None."""
        return self.state_machines.get(state_machine_id)

    def is_state_machine_open(self, file_system_path):
        """Whether the state machine of a folder is known."""
        return self.get_open_state_machine_of_file_system_path(file_system_path) is not None

    def get_open_state_machine_of_file_system_path(self, file_system_path):
        """The state machine of a folder if it is known, else None."""
        wanted = os.path.realpath(file_system_path)
        for machine in self.state_machines.values():
            if machine.file_system_path is not None and os.path.realpath(machine.file_system_path) == wanted:
                return machine
        return None

    def get_sm_id_for_root_state_id(self, root_state_id):
        """The id of the first state machine whose root state has this id, or None."""
        machines = self.state_machines.items()
        return next((key for key, machine in machines if machine.root_state.state_id == root_state_id), None)

    def has_dirty_state_machine(self):
        """Whether there are changes that are not saved."""
        return any(machine.marked_dirty for machine in self.state_machines.values())
