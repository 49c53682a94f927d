"""Constants of the parts of a state machine."""

#: The id of the decider in every barrier.
UNIQUE_DECIDER_STATE_ID = "unique_decider_state_id"


def __getattr__(name):
    """Create the folder ``RAFCON_TEMP_PATH_STORAGE`` (``DEFAULT_SCRIPT_PATH``) on first use."""
    if name in ("RAFCON_TEMP_PATH_STORAGE", "DEFAULT_SCRIPT_PATH"):
        from rafcon.utils.constants import RAFCON_TEMP_PATH_STORAGE

        return RAFCON_TEMP_PATH_STORAGE
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
