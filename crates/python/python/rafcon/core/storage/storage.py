"""Names of the files of a state machine; loading and saving is done from outside the running machine."""

from rafcon.core.custom_exceptions import MachineChangeNotSupported

#: The header of a state machine.
STATEMACHINE_FILE = "statemachine.json"
#: A state.
FILE_NAME_CORE_DATA = "core_data.json"
#: The layout of a state.
FILE_NAME_META_DATA = "meta_data.json"
#: The layout of a state machine.
FILE_NAME_META_DATA_SM = "sm_meta_data.json"
#: The script of a state.
SCRIPT_FILE = "script.py"
#: The semantic data of a state.
SEMANTIC_DATA_FILE = "semantic_data.json"
#: Between name and id in the name of a state's folder.
ID_NAME_DELIMITER = "_"


def load_state_machine_from_path(base_path, state_machine_id=None):
    """Would load a second machine beside the running one: refused."""
    raise MachineChangeNotSupported("storage.load_state_machine_from_path(…)")


def save_state_machine_to_path(state_machine, base_path, delete_old_state_machine=False, as_copy=False):
    """Would save the running machine: refused."""
    raise MachineChangeNotSupported("storage.save_state_machine_to_path(…)")
