"""Containers that wait for all their states, and the deciders that choose their outcomes."""

from rafcon import _ids
from rafcon.core.state_elements.logical_port import Outcome
from rafcon.core.states.concurrency_state import ConcurrencyState
from rafcon.core.states.execution_state import ExecutionState

#: The id of the decider in every barrier.
UNIQUE_DECIDER_STATE_ID = "unique_decider_state_id"


class BarrierConcurrencyState(ConcurrencyState):
    """Container that runs its states in parallel and waits for all; a decider sets the outcome.

    A new one gets a new decider, unless ``decider_state`` is given. The other arguments are those
    of any container.
    """

    _kind = "barrier"

    def __init__(self, *arguments, decider_state=None, load_from_storage=False, **named):
        self._decider = decider_state
        ConcurrencyState.__init__(self, *arguments, **named)

    def _put_in(self, state):
        if isinstance(state, DeciderState):
            self._decider = state
        else:
            self.add_state(state)

    def add_state(self, state, storage_load=False):
        """Add a state as in any container; its outcomes from 0 on lead to the decider."""
        known = set(self._facts["transitions"])
        state_id = ConcurrencyState.add_state(self, state, storage_load)
        if self._place < 0:
            self._renumber({key: ends for key, ends in self._facts["transitions"].items() if key not in known})
        return state_id

    def _renumber(self, transitions):
        """Give automatic transitions the ids that they would have if they had been added."""
        taken = (set(self._facts["transitions"]) - set(transitions)).__contains__
        removals = [("transition.remove", (key,)) for key in transitions]
        self._home.change(self, removals + [("transition.add", (_ids.transition_id(taken), *ends)) for ends in transitions.values()])

    def _complete(self):
        decider = self._decider or DeciderState("Decider", UNIQUE_DECIDER_STATE_ID)
        del self._decider
        self.add_state(decider)


class DeciderState(ExecutionState):
    """State that runs last in a barrier; its script can read the results of the others.

    ``final_outcomes_dict`` maps the id of every state to (name, :class:`Outcome`). ``child_errors``
    maps the ids of states that left an error to (name, error).
    """

    _kind = "decider"

    def _begin(self, name, state_id):
        ExecutionState._begin(self, name, UNIQUE_DECIDER_STATE_ID if state_id is None else state_id)

    def _init_run(self, signals):
        ExecutionState._init_run(self, signals)
        self.child_errors = {}
        self.final_outcomes_dict = {}

    def _set_verdicts(self, verdicts):
        self.final_outcomes_dict = {
            state_id: (name, Outcome(outcome_id, outcome_name))
            for state_id, name, outcome_id, outcome_name, _error in verdicts
        }
        self.child_errors = {
            state_id: (name, error) for state_id, name, _id, _outcome, error in verdicts if error is not None
        }

    def get_outcome_for_state_name(self, name):
        """:class:`Outcome` of the first state with this name, or None."""
        return next((outcome for found, outcome in self.final_outcomes_dict.values() if found == name), None)

    def get_outcome_for_state_id(self, state_id):
        """:class:`Outcome` of the state with this id, or None."""
        return self.final_outcomes_dict.get(state_id, (None, None))[1]

    def get_errors_for_state_name(self, name):
        """Error of the first state with this name that left one, or None."""
        return next((error for found, error in self.child_errors.values() if found == name), None)
