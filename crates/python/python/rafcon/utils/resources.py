"""Search in the folders for shared files."""

import os
import sys

#: The user's data folder.
xdg_user_data_folder = os.environ.get("XDG_DATA_HOME") or os.path.join(os.path.expanduser("~"), ".local", "share")

#: All data folders; the first match is used.
share_folder_paths = [xdg_user_data_folder, os.path.join(sys.prefix, "share"), "/usr/local/share", "/usr/share"]


def search_in_share_folders(*rel_path):
    """First file or folder with this relative path in any of the folders, or None."""
    candidates = (os.path.join(folder, *rel_path) for folder in share_folder_paths)
    return next((path for path in candidates if os.path.exists(path)), None)


def get_data_file_path(*rel_path):
    """First file or folder with this path below the folder ``rafcon`` of any of them, or None."""
    return search_in_share_folders("rafcon", *rel_path)
