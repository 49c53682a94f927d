"""Constants of the state machine's parts."""

#: The id of the decider in every barrier.
UNIQUE_DECIDER_STATE_ID = "unique_decider_state_id"


def __getattr__(name):
    """``RAFCON_TEMP_PATH_STORAGE`` and ``DEFAULT_SCRIPT_PATH``: the folder is made when it is first asked for."""
    if name in ("RAFCON_TEMP_PATH_STORAGE", "DEFAULT_SCRIPT_PATH"):
        from rafcon.utils.constants import RAFCON_TEMP_PATH_STORAGE

        return RAFCON_TEMP_PATH_STORAGE
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
