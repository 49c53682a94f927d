from logging import Logger
from os import PathLike
from typing import Any

from rafcon.core.state_machine import StateMachine
from rafcon.core.states.state import State

logger: Logger
STATEMACHINE_FILE: str
FILE_NAME_CORE_DATA: str
FILE_NAME_META_DATA: str
FILE_NAME_META_DATA_SM: str
SCRIPT_FILE: str
SEMANTIC_DATA_FILE: str
ID_NAME_DELIMITER: str
LIBRARY_NOT_FOUND_DUMMY_STATE_NAME: str

def load_state_machine_from_path(
    base_path: str | PathLike[str], state_machine_id: int | None = None
) -> StateMachine: ...
def save_state_machine_to_path(
    state_machine: StateMachine,
    base_path: str | PathLike[str],
    delete_old_state_machine: bool = False,
    as_copy: bool = False,
) -> None: ...
def load_data_file(path_of_file: str | PathLike[str]) -> Any: ...
def get_core_data_path(state_path: str) -> str: ...
def get_meta_data_path(state_path: str) -> str: ...
def get_storage_id_for_state(state: State) -> str: ...
def clean_path_element(text: str) -> str: ...
def limit_text_max_length(text: str, max_length: int, separator: str = "_") -> str: ...
