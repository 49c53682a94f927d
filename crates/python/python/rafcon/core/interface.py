"""How a program asks its user for folders and shows notices: functions that it may replace by its own.

``open_folder_func``, ``create_folder_func``, ``save_folder_func`` and ``show_notice_func`` are those in force; they
begin as the functions for a terminal. Nothing in this package calls them: machines are loaded without questions.
"""

import os
from builtins import input  # the name is here so that programs and tests can replace it


def open_folder_cmd_line(query, default_path=None):
    """A folder that is there, as the user types it; ``default_path`` if nothing is typed, None if there is none."""
    default = "" if default_path is None else f" [default {default_path}]"
    path = input(f"{query}{default}: ") or default_path
    return path if path and os.path.isdir(path) else None


def create_folder_cmd_line(query, default_name=None, default_path=None):
    """A folder that is made if it is not there; None if it cannot be."""
    path = _named_or_default(query, default_name, default_path)
    try:
        if path is not None:
            os.makedirs(path, exist_ok=True)
    except OSError:
        return None
    return path


def save_folder_cmd_line(query, default_name=None, default_path=None):
    """A folder to save to, which need not be there yet; None if it has nowhere to be."""
    path = _named_or_default(query, default_name, default_path)
    return path if path is not None and os.path.isdir(os.path.dirname(path) or ".") else None


def show_notice(notice, custom_buttons=None):
    """Shows a text and waits for the return key; there are no buttons on a terminal."""
    input(notice)


def _named_or_default(query, name, folder):
    default = os.path.join(folder, name) if name and folder else None
    return input(f"{query} [default {default}]: ") or default


open_folder_func = open_folder_cmd_line
create_folder_func = create_folder_cmd_line
save_folder_func = save_folder_cmd_line
show_notice_func = show_notice
