"""Folders for temporary files, created when this module is imported."""

import atexit
import contextlib
import getpass
import os
import tempfile

#: The system's folder for temporary files.
TEMP_PATH = tempfile.gettempdir()


def _user():
    try:
        return getpass.getuser()
    except (KeyError, OSError):
        return str(os.getuid())


def _made():
    """Create the folder of this process, and another one inside; return both paths.

    If they cannot be created, errors occur on their first use.
    """
    base = os.path.join(TEMP_PATH, f"rafcon-{_user()}", str(os.getpid()))
    try:
        os.makedirs(base, exist_ok=True)
        return base, tempfile.mkdtemp(dir=base)
    except OSError:
        return base, base


def _remove_if_empty(owner):
    if os.getpid() == owner:
        for folder in (RAFCON_TEMP_PATH_STORAGE, RAFCON_TEMP_PATH_BASE):
            with contextlib.suppress(OSError):
                os.rmdir(folder)


#: The folder of this process below it, and the one for all other files. Empty folders are removed when the process ends.
RAFCON_TEMP_PATH_BASE, RAFCON_TEMP_PATH_STORAGE = _made()
atexit.register(_remove_if_empty, os.getpid())

#: Methods whose notifications to observers of a state come from execution, not from edits.
BY_EXECUTION_TRIGGERED_OBSERVABLE_STATE_METHODS = [
    "state_execution_status",
    "_add_new_execution_history",
    "clear_execution_histories",
]
