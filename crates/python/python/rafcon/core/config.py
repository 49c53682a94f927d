"""The configuration: the keys of ``config.yaml`` that scripts and plugins ask for."""

import os
from logging import DEBUG, INFO, WARNING

from rafcon._bridge import native
from rafcon.design_patterns.observer.observable import Observable
from rafcon.utils.log import get_logger

logger = get_logger(__name__)

DEFAULTS = {
    "TYPE": "SM_CONFIG",
    "LIBRARY_PATHS": {},
    "LIBRARY_RECOVERY_MODE": False,
    "LOAD_SM_WITH_CHECKS": True,
    "STORAGE_PATH_WITH_STATE_NAME": True,
    "MAX_LENGTH_FOR_STATE_NAME_IN_STORAGE_PATH": None,
    "NO_PROGRAMMATIC_CHANGE_OF_LIBRARY_STATES_PERFORMED": False,
    "IN_MEMORY_EXECUTION_HISTORY_ENABLE": True,
    "FILE_SYSTEM_EXECUTION_HISTORY_ENABLE": False,
    "EXECUTION_LOG_PATH": "%RAFCON_TEMP_PATH_BASE/execution_logs",
    "EXECUTION_LOG_SET_READ_AND_WRITABLE_FOR_ALL": False,
    "SCRIPT_RECOMPILATION_ON_STATE_EXECUTION": True,
    "RAISE_ERROR_ON_MISSING_LIBRARY_STATES": False,
    "DEFAULT_LOG_PATH": os.path.join("~", ".log", "rafcon"),
}


class ObservableConfig(Observable):
    """Base of configurations: key to value, in a YAML file."""


class Config(ObservableConfig):
    """Key to value. In a running machine it holds the configuration in force; changes last until the process ends."""

    def __init__(self):
        self._values = dict(DEFAULTS)
        #: The last file read, or None.
        self._path = None

    def load(self, config_file=None, path=None):
        """Reads a ``config.yaml`` in the folder ``path`` (``~/.config/rafcon``); without a file, defaults hold.

        Nothing is written. A missing file is a warning in the log if it was named itself, and not its folder only.
        """
        folder = os.path.expanduser(path or os.path.join("~", ".config", "rafcon"))
        file = os.path.join(folder, config_file or "config.yaml")
        if not os.path.isfile(file):
            level = WARNING if config_file is not None else DEBUG if path is None else INFO
            logger.log(level, "there is no configuration %s; defaults hold", file)
            return
        values, problems = native.read_config(file)
        for problem in problems:
            logger.warning("%s: %s", file, problem)
        self._path = file
        self._replace(values)

    def get_config_value(self, key, default=None):
        """The value of a key, or ``default`` if the key is not known."""
        return self._values.get(key, default)

    @Observable.observed
    def set_config_value(self, key, value):
        """Changes a value for other scripts to see; files and the machine that runs stay as they are."""
        self._values[key] = value

    def is_config_loaded_from_file(self):
        """Whether a file was read."""
        return self._path is not None

    def get_all_keys(self):
        """All keys."""
        return list(self._values)

    keys = property(get_all_keys, doc="All keys.")

    def as_dict(self):
        """A copy: key to value."""
        return dict(self._values)

    def _replace(self, values):
        self._values = {**DEFAULTS, **values}


#: The configuration of this process.
global_config = Config()
