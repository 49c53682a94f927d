"""Configuration: the keys of ``config.yaml`` that scripts and plugins read."""

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
    """Base class of configurations: key to value, in a YAML file."""


class Config(ObservableConfig):
    """Configuration of this process: key to value. Changes last until the process ends.

    In a running machine it holds the configuration of the run.
    """

    def __init__(self):
        self._values = dict(DEFAULTS)
        #: The last file read, or None.
        self._path = None

    def load(self, config_file=None, path=None):
        """Read a ``config.yaml`` in the folder ``path`` (default ``~/.config/rafcon``).

        Writes no file. If the file is missing, the values stay as they are, and the log has an
        entry: a warning if ``config_file`` was given.
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
        """Value of a key, or ``default`` if the key is unknown."""
        return self._values.get(key, default)

    @Observable.observed
    def set_config_value(self, key, value):
        """Change a value for other scripts; files and the running machine are not affected."""
        self._values[key] = value

    def is_config_loaded_from_file(self):
        """True if a file was read."""
        return self._path is not None

    def get_all_keys(self):
        """All keys."""
        return list(self._values)

    keys = property(get_all_keys, doc="All keys.")

    def as_dict(self):
        """Copy of the configuration: key to value."""
        return dict(self._values)

    def _replace(self, values):
        self._values = {**DEFAULTS, **values}


#: The configuration of this process.
global_config = Config()
