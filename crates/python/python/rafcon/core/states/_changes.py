"""Changes of a state: its name, outcomes and ports.

In the running machine they take effect at its next step.
"""

from rafcon.core.decorators import lock_state_machine
from rafcon.core.state_elements.data_port import InputDataPort, OutputDataPort
from rafcon.core.state_elements.logical_port import Income, Outcome
from rafcon.utils.log import get_logger
from rafcon.utils.type_helpers import named

logger = get_logger(__name__)


class StateChanges:
    """Base class of states with the methods that change a state."""

    def _rename(self, name):
        if not isinstance(name, str):
            raise TypeError(f"the name of a state must be a str, not {type(name).__name__}")
        self._change("state.name", name)

    def _describe(self, description):
        if description is not None and not isinstance(description, str):
            raise TypeError(f"a description must be a str, not {type(description).__name__}")
        self._change("state.description", description or None)

    def change_state_id(self, state_id=None):
        """Change the id of the state (to a new one by default); its connections follow."""
        from rafcon import _ids

        above = self.parent
        around = getattr(above, "states", {})
        state_id = _ids.state_id(around) if state_id is None else state_id
        self._change("state.id", state_id)
        self._home.renamed(self, state_id)

    @lock_state_machine
    def add_outcome(self, name, outcome_id=None):
        """Add an outcome and return its id; if the id is taken, log an error and return None."""
        if outcome_id is None:
            outcome_id = self._facts["free_outcome_id"]
        elif outcome_id in self._facts["outcomes"]:
            logger.error("%s has an outcome with the id %s already", self, outcome_id)
            return None
        self._change("outcome.add", outcome_id, named(name))
        return outcome_id

    def remove_outcome(self, outcome_id, force=False, destroy=True):
        """Remove an outcome with its transitions, and return it."""
        return self._remove_part(self.outcomes, outcome_id, "outcome.remove", outcome_id)

    def remove_income(self, force=False, destroy=True):
        """Raise ``AttributeError``: every state has an income."""
        raise AttributeError(f"the income of {self} cannot be removed; every state has one")

    def add_input_data_port(self, name, data_type=None, default_value=None, data_port_id=None):
        """Add an input and return its id."""
        return self._add_port("inputs", name, data_type, default_value, data_port_id)

    def remove_input_data_port(self, data_port_id, force=False, destroy=True):
        """Remove an input with its data flows, and return it."""
        return self._remove_part(self.input_data_ports, data_port_id, "port.remove", "inputs", data_port_id)

    def add_output_data_port(self, name, data_type, default_value=None, data_port_id=None):
        """Add an output and return its id."""
        return self._add_port("outputs", name, data_type, default_value, data_port_id)

    def remove_output_data_port(self, data_port_id, force=False, destroy=True):
        """Remove an output with its data flows, and return it."""
        return self._remove_part(self.output_data_ports, data_port_id, "port.remove", "outputs", data_port_id)

    def remove(self, state_element, recursive=True, force=False, destroy=True):
        """Remove an element of any kind from the state."""
        if isinstance(state_element, Income):
            return self.remove_income(force)
        for cls, remove in self._removals():
            if isinstance(state_element, cls):
                return remove(state_element.core_element_id)
        raise ValueError(f"{state_element!r} is no element that {self} could have")

    def _removals(self):
        return [
            (Outcome, self.remove_outcome),
            (InputDataPort, self.remove_input_data_port),
            (OutputDataPort, self.remove_output_data_port),
        ]

    def _remove_part(self, parts, key, verb, *arguments):
        part = parts.get(key)
        if part is None:
            raise AttributeError(f"{self} has no such element with the id {key!r}")
        part._content()
        self._change(verb, *arguments)
        part._detach()
        return part
