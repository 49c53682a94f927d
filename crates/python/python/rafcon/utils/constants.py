"""Folders for temporary files."""

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


#: The folder of this process below it; made when it is first asked for by ``os.makedirs``.
RAFCON_TEMP_PATH_BASE = os.path.join(TEMP_PATH, f"rafcon-{_user()}", str(os.getpid()))
