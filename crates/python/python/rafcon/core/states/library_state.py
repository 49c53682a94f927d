"""States that run another state machine."""

from rafcon import _objects
from rafcon.core._refusals import fixed, refuses
from rafcon.core.states.state import State


@refuses(
    "set_input_runtime_value",
    "set_output_runtime_value",
    "set_use_input_runtime_value",
    "set_use_output_runtime_value",
)
class LibraryState(State):
    """A state that stands for a library; the library's root is ``state_copy``."""

    @fixed
    def library_path(self):
        """Where the library lies: the key of a library root, and folders below it."""
        return self._facts["library"]["path"]

    @fixed
    def library_name(self):
        """The name of the library's folder."""
        return self._facts["library"]["name"]

    @fixed
    def version(self):
        """The version (``str``) of the library that was put in."""
        return self._facts["library"]["version"]

    @fixed
    def state_copy(self):
        """The root state of the library."""
        return next((_objects.state(place) for place in self._facts["children"].values()), None)

    @fixed
    def input_data_port_runtime_values(self):
        """Port id to the value used here instead of the port's default."""
        return self._facts["library"]["input_runtime_values"]

    @fixed
    def output_data_port_runtime_values(self):
        """Port id to the value used here instead of the port's default."""
        return self._facts["library"]["output_runtime_values"]

    @fixed
    def use_runtime_value_input_data_ports(self):
        """Port id to whether the runtime value is used."""
        return self._facts["library"]["use_input_runtime_values"]

    @fixed
    def use_runtime_value_output_data_ports(self):
        """Port id to whether the runtime value is used."""
        return self._facts["library"]["use_output_runtime_values"]

    @property
    def library_hierarchy_depth(self):
        """In how many libraries this state is, itself included."""
        return 1 + len(self._library_roots())

    def recursively_preempt_states(self):
        """Preempts this state and all states of the library."""
        State.recursively_preempt_states(self)
        self.state_copy.recursively_preempt_states()

    def recursively_pause_states(self):
        """Holds this state and all states of the library."""
        State.recursively_pause_states(self)
        self.state_copy.recursively_pause_states()

    def recursively_resume_states(self):
        """Lets this state and all states of the library go on."""
        State.recursively_resume_states(self)
        self.state_copy.recursively_resume_states()
