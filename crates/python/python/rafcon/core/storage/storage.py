"""Loading and saving of state machines, and the names of their files."""

import json
import os
import re
import shutil
import tempfile

from rafcon._bridge import native
from rafcon.core.config import global_config
from rafcon.core.custom_exceptions import LibraryNotFoundException, MachineChangeNotSupported
from rafcon.utils.log import get_logger

logger = get_logger(__name__)

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
#: Separator of name and id in the name of a state's folder.
ID_NAME_DELIMITER = "_"
#: The name of a library state whose library is missing.
LIBRARY_NOT_FOUND_DUMMY_STATE_NAME = "LIBRARY NOT FOUND DUMMY STATE"
#: Replacements in folder names for characters that some system forbids.
REPLACED_CHARACTERS_FOR_NO_OS_LIMITATION = {
    **dict.fromkeys("/\\<>", ""),
    "\\0": "",
    **dict.fromkeys(":|?*", "_"),
}



def load_state_machine_from_path(base_path, state_machine_id=None):
    """Load the :class:`~rafcon.core.state_machine.StateMachine` in a folder.

    Raises ``ValueError`` if there is none. Faults of its files, and of the machine itself, are
    logged as errors, and the rest of the machine is loaded. If
    ``RAISE_ERROR_ON_MISSING_LIBRARY_STATES`` is set, a missing library raises
    ``LibraryNotFoundException``.
    """
    from rafcon.core.singleton import library_manager
    from rafcon.core.state_machine import StateMachine

    document, problems = native.load_document(str(base_path), library_manager._roots())
    for problem in problems:
        logger.error("%s: %s", base_path, problem)
    machine = StateMachine._loaded(document, state_machine_id)
    machine.root_state._problems_told = frozenset(problems)
    if global_config.get_config_value("RAISE_ERROR_ON_MISSING_LIBRARY_STATES"):
        _refuse_missing(machine.root_state)
    return machine


def _refuse_missing(state):
    if getattr(state, "is_dummy", False):
        reference = f"{state.library_path}/{state.library_name}"
        raise LibraryNotFoundException(f"the library `{reference}` of the state {state.get_path()} is missing")
    for child in getattr(state, "states", {}).values():
        _refuse_missing(child)


def save_state_machine_to_path(state_machine, base_path, delete_old_state_machine=False, as_copy=False):
    """Save a machine to a folder. The save is atomic, except with ``delete_old_state_machine``.

    With ``as_copy`` the machine keeps its previous folder. ``delete_old_state_machine`` also
    deletes everything else in the folder; the old folder is restored after an error, but not after
    a crash.
    """
    if state_machine._facts is not None:
        raise MachineChangeNotSupported("storage.save_state_machine_to_path(…)")
    base_path = _folder(base_path)
    document = state_machine._document
    with state_machine.modification_lock():
        if delete_old_state_machine and os.path.exists(base_path):
            _replace(document, os.path.abspath(base_path), as_copy)
        else:
            native.save_document(document, base_path, _naming(), (as_copy, False))
    if not as_copy:
        state_machine._marked_dirty = False
        state_machine.root_state._home.revision += 1


def _folder(path):
    """Convert a path to text; ``TypeError`` for None, the path of an unsaved machine."""
    if path is None:
        raise TypeError("a folder to save to is needed, not None; name one, the machine has no folder yet")
    return os.fsdecode(os.fspath(path))


def _replace(document, folder, as_copy):
    """Replace a whole folder by the machine; if that fails, the old folder is restored."""
    aside = tempfile.mkdtemp(prefix=".replaced-", dir=os.path.dirname(folder))
    earlier = os.path.join(aside, "earlier")
    os.rename(folder, earlier)
    try:
        native.save_document(document, folder, _naming(), (as_copy, True))
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        os.rename(earlier, folder)
        raise
    finally:
        shutil.rmtree(aside)


def _naming():
    length = global_config.get_config_value("MAX_LENGTH_FOR_STATE_NAME_IN_STORAGE_PATH")
    length = length if isinstance(length, int) and length > 0 else None
    return bool(global_config.get_config_value("STORAGE_PATH_WITH_STATE_NAME")), length


def get_storage_id_for_state(state):
    """Name (``str``) of the folder that a state gets when its machine is saved."""
    with_name, length = _naming()
    if not with_name:
        return state.state_id
    suffix = ID_NAME_DELIMITER + state.state_id
    return limit_text_max_length(clean_path_element(state._facts["name"]), length or 255 - len(suffix)) + suffix


def get_core_data_path(state_path):
    """Path of a state's core data in its folder."""
    return os.path.join(state_path, FILE_NAME_CORE_DATA)


def get_meta_data_path(state_path):
    """Path of a state's layout in its folder."""
    return os.path.join(state_path, FILE_NAME_META_DATA)


def load_data_file(path_of_file):
    """Content of a machine's JSON file as plain dictionaries; ``ValueError`` if it is missing."""
    if not os.path.isfile(path_of_file):
        raise ValueError(f"there is no file {path_of_file}")
    with open(path_of_file, encoding="utf-8") as file:
        return json.load(file)


def clean_path_element(text):
    """Reduce a name to letters, digits, ``_`` and ``-``."""
    return re.sub("[^a-zA-Z0-9_-]", "", re.sub("[ *]", "_", text))


def limit_text_max_length(text, max_length, separator="_"):
    """Shorten a text to ``max_length`` characters: its beginning and its end."""
    if len(text) <= max_length:
        return text
    half = (max_length - 1) / 2
    head, tail = int(half + 0.5), int(half)
    return text[:head] + separator + text[len(text) - tail :]
