"""The state machines of this process: there is one, the one that runs."""

from rafcon import _objects
from rafcon.core._refusals import fixed, refuses


@refuses(
    "add_state_machine",
    "remove_state_machine",
    "remove_state_machine_by_path",
    "delete_all_state_machines",
    "open_state_machines",
)
class StateMachineManager:
    """Knows the state machine that runs."""

    @staticmethod
    def instance():
        """The manager of this process."""
        from rafcon.core.singleton import state_machine_manager

        return state_machine_manager

    @fixed
    def state_machines(self):
        """Id to :class:`~rafcon.core.state_machine.StateMachine`; empty where none runs."""
        machine = self.get_active_state_machine()
        return {} if machine is None else {machine.state_machine_id: machine}

    @fixed
    def active_state_machine_id(self):
        """The id of the state machine that runs, or None."""
        machine = self.get_active_state_machine()
        return None if machine is None else machine.state_machine_id

    def get_active_state_machine(self):
        """The state machine that runs, or None."""
        return _objects.machine_or_none()

    def get_state_machine(self, state_machine_id):
        """The state machine of this id, or None."""
        return self.state_machines.get(state_machine_id)

    def is_state_machine_open(self, file_system_path):
        """Whether the state machine of a folder is the one that runs."""
        return self.get_open_state_machine_of_file_system_path(file_system_path) is not None

    def get_open_state_machine_of_file_system_path(self, file_system_path):
        """The state machine of a folder if it is the one that runs, else None."""
        machine = self.get_active_state_machine()
        return machine if machine is not None and machine.file_system_path == file_system_path else None

    def has_dirty_state_machine(self):
        """Whether there are changes that are not saved; a running machine has none."""
        return False
