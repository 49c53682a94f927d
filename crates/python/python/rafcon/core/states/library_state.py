"""States that run another state machine."""

from rafcon.core.states._own_values import OwnValues
from rafcon.core.states.state import State
from rafcon.core.storage.storage import LIBRARY_NOT_FOUND_DUMMY_STATE_NAME
from rafcon.utils.type_helpers import port_default


class LibraryState(State):
    """State that runs a library; the library's root is ``state_copy``.

    Outcomes and ports are those of the library, and cannot be changed here
    (``NotImplementedError``). A port's default can be replaced by a value of the state's own. The
    default name is that of the library's root.
    """

    _kind = "library"
    #: Ids of the ports whose default was set here.
    _own_defaults = frozenset()

    def __init__(
        self,
        library_path,
        library_name,
        version=None,
        name=None,
        state_id=None,
        income=None,
        outcomes=None,
        input_data_port_runtime_values=None,
        use_runtime_value_input_data_ports=None,
        output_data_port_runtime_values=None,
        use_runtime_value_output_data_ports=None,
        allow_user_interaction=True,
        safe_init=True,
        skip_runtime_data_initialization=False,
    ):
        from rafcon.core.singleton import library_manager

        named = (name, state_id)
        document, state_id = library_manager._document(library_path, library_name, version, named)
        self._settle_alone(document, state_id)
        inputs = (input_data_port_runtime_values, use_runtime_value_input_data_ports)
        self._take_values("inputs", self.input_data_ports, *inputs)
        outputs = (output_data_port_runtime_values, use_runtime_value_output_data_ports)
        self._take_values("outputs", self.output_data_ports, *outputs)

    def _take_values(self, group, ports, values, used):
        for key, value in (values or {}).items():
            self._set_value(group, ports, key, value)
        for key, use in (used or {}).items():
            self._change("runtime.used", group, key, bool(use))

    def _set_value(self, group, ports, key, value):
        self._change("runtime.set", group, key, port_default(value, ports[key].data_type))

    def set_input_runtime_value(self, input_data_port_id, value):
        """Set the state's own value for an input; text is converted to the port's type."""
        self._set_value("inputs", self.input_data_ports, input_data_port_id, value)

    def set_output_runtime_value(self, output_data_port_id, value):
        """Set the state's own value for an output; text is converted to the port's type."""
        self._set_value("outputs", self.output_data_ports, output_data_port_id, value)

    def set_use_input_runtime_value(self, input_data_port_id, use_value):
        """Select the state's own value (True) or the library's default for an input."""
        self._change("runtime.used", "inputs", input_data_port_id, bool(use_value))

    def set_use_output_runtime_value(self, output_data_port_id, use_value):
        """Select the state's own value (True) or the library's default for an output."""
        self._change("runtime.used", "outputs", output_data_port_id, bool(use_value))

    @property
    def name(self):
        """Name (``str``), or a fixed name if the library of a loaded machine is missing."""
        if self.is_dummy:
            return LIBRARY_NOT_FOUND_DUMMY_STATE_NAME
        return self._facts["name"]

    @name.setter
    def name(self, name):
        self._rename(name)

    @property
    def is_dummy(self):
        """True if the library of a loaded machine is missing."""
        return hasattr(self._home, "document") and not self._home.child_ids(self)

    @property
    def library_path(self):
        """Location of the library: the key of a library root, and folders below it."""
        return self._facts["library"]["path"]

    @property
    def library_name(self):
        """Name of the library's folder."""
        return self._facts["library"]["name"]

    @property
    def version(self):
        """Version (``str``) of the library when it was added."""
        return self._facts["library"]["version"]

    @property
    def state_copy(self):
        """Root state of the library, or None if the library is missing."""
        ids = self._home.child_ids(self)
        return self._home.child(self, ids[0]) if ids else None

    def _own(self, side, is_use):
        """Live dictionary of a side, of own values or of their use."""
        key = (side, is_use)
        if key not in self._listed:
            set_value = self.set_input_runtime_value if side == "input" else self.set_output_runtime_value
            set_use = self.set_use_input_runtime_value if side == "input" else self.set_use_output_runtime_value
            # One dictionary per description of the state.
            known = [None, None]

            def read():
                if known[0] is not self._facts:
                    known[:] = self._facts, self._own_values(side, is_use)
                return known[1]

            self._listed[key] = OwnValues(read, set_use if is_use else set_value)
        return self._listed[key]

    def _own_values(self, side, is_use):
        """Port id to content; the library's default for ports missing in the machine's file."""
        facts = self._facts
        kept = facts["library"][f"use_{side}_runtime_values" if is_use else f"{side}_runtime_values"]
        ports = facts[f"{side}s"]
        return {**{key: True if is_use else default for key, (_name, _type, default) in ports.items()}, **kept}

    def _assign(self, name, values):
        if not isinstance(values, dict):
            raise TypeError(f"`{name}` must be a dict, not {type(values).__name__}")
        getattr(self, name).update(values)

    @property
    def input_data_port_runtime_values(self):
        """Port id to the state's own value; can be changed in place, or assigned."""
        return self._own("input", False)

    @input_data_port_runtime_values.setter
    def input_data_port_runtime_values(self, values):
        self._assign("input_data_port_runtime_values", values)

    @property
    def output_data_port_runtime_values(self):
        """Port id to the state's own value; can be changed in place, or assigned."""
        return self._own("output", False)

    @output_data_port_runtime_values.setter
    def output_data_port_runtime_values(self, values):
        self._assign("output_data_port_runtime_values", values)

    @property
    def use_runtime_value_input_data_ports(self):
        """Port id to True if the own value is used; can be changed in place, or assigned."""
        return self._own("input", True)

    @use_runtime_value_input_data_ports.setter
    def use_runtime_value_input_data_ports(self, used):
        self._assign("use_runtime_value_input_data_ports", used)

    @property
    def use_runtime_value_output_data_ports(self):
        """Port id to True if the own value is used; can be changed in place, or assigned."""
        return self._own("output", True)

    @use_runtime_value_output_data_ports.setter
    def use_runtime_value_output_data_ports(self, used):
        self._assign("use_runtime_value_output_data_ports", used)

    def _set_default(self, port, default):
        """Make a new default of a port the state's own value; the library stays unchanged."""
        self._change("runtime.set", port._group, port.data_port_id, default)
        self._change("runtime.used", port._group, port.data_port_id, True)
        self._own_defaults = {*self._own_defaults, (port._group, port.data_port_id)}

    def _own_default(self, port):
        """Return True if the port's default was set here, and the port's own value."""
        key, side = port.data_port_id, "input" if port._group == "inputs" else "output"
        is_own = (port._group, key) in self._own_defaults
        return is_own, self._facts["library"][f"{side}_runtime_values"].get(key)

    def recursively_preempt_states(self):
        """Preempt this state and all states of the library."""
        State.recursively_preempt_states(self)
        self.state_copy.recursively_preempt_states()

    def recursively_pause_states(self):
        """Hold this state and all states of the library."""
        State.recursively_pause_states(self)
        self.state_copy.recursively_pause_states()

    def recursively_resume_states(self):
        """Resume this state and all states of the library."""
        State.recursively_resume_states(self)
        self.state_copy.recursively_resume_states()
