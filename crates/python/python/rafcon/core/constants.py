"""Constants of the state machine's parts."""

#: The id of the decider in every barrier.
UNIQUE_DECIDER_STATE_ID = "unique_decider_state_id"
