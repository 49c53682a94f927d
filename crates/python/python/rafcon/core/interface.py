"""Functions with which a program asks its user for folders and shows notices; replaceable.

``open_folder_func``, ``create_folder_func``, ``save_folder_func`` and ``show_notice_func`` are the
active functions. Initially they are those for a terminal. Nothing in this package calls them:
machines are loaded without questions.
"""

import os
from builtins import input  # the name is here so that programs and tests can replace it


def open_folder_cmd_line(query, default_path=None):
    """Ask for an existing folder; ``default_path`` on empty input, None if it does not exist."""
    default = "" if default_path is None else f" [default {default_path}]"
    path = input(f"{query}{default}: ") or default_path
    return path if path and os.path.isdir(path) else None


def create_folder_cmd_line(query, default_name=None, default_path=None):
    """Ask for a folder and create it if it is missing; None if that fails."""
    path = _named_or_default(query, default_name, default_path)
    try:
        if path is not None:
            os.makedirs(path, exist_ok=True)
    except OSError:
        return None
    return path


def save_folder_cmd_line(query, default_name=None, default_path=None):
    """Ask for a folder to save to, which may be missing; None if its parent folder is missing."""
    path = _named_or_default(query, default_name, default_path)
    return path if path is not None and os.path.isdir(os.path.dirname(path) or ".") else None


def show_notice(notice, custom_buttons=None):
    """Show a text and wait for the return key; a terminal has no buttons."""
    input(notice)


def _named_or_default(query, name, folder):
    default = os.path.join(folder, name) if name and folder else None
    return input(f"{query} [default {default}]: ") or default


open_folder_func = open_folder_cmd_line
create_folder_func = create_folder_cmd_line
save_folder_func = save_folder_cmd_line
show_notice_func = show_notice
