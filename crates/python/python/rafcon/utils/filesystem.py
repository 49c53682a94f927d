"""Files and folders."""

import os
import shutil
import stat
import tarfile


def create_path(path):
    """Create a folder and its parents if they are missing."""
    os.makedirs(path, exist_ok=True)


def get_default_config_path():
    """User's folder for configurations, ``~/.config/rafcon``; created if missing."""
    return _home(".config")


def get_default_log_path():
    """User's folder for logs, ``~/.log/rafcon``; created if missing."""
    return _home(".log")


def _home(name):
    path = os.path.join(os.path.expanduser("~"), name, "rafcon")
    create_path(path)
    return path


def write_file(file_path, content, create_full_path=False):
    """Write a text to a file; with ``create_full_path``, create missing folders."""
    if create_full_path:
        create_path(os.path.dirname(os.path.abspath(file_path)))
    with open(file_path, "w", encoding="utf-8") as file:
        file.write(content)


def read_file(file_path, filename=None):
    """Text of a file, or of ``filename`` in a folder; None if it is missing."""
    path = os.path.join(file_path, filename or "") if filename else file_path
    if not os.path.isfile(path):
        return None
    with open(path, encoding="utf-8") as file:
        return file.read()


def clean_file_system_paths_from_not_existing_paths(file_system_paths):
    """Remove missing files and folders from a list of paths, in place."""
    file_system_paths[:] = [path for path in file_system_paths if os.path.exists(path)]


def separate_folder_path_and_file_name(path):
    """Folder and name of a file; for a folder, the folder and None."""
    return (path, None) if os.path.isdir(path) else os.path.split(path)


def make_file_executable(filename):
    """Make a file executable for its owner."""
    os.chmod(filename, os.stat(filename).st_mode | stat.S_IXUSR)


def make_tarfile(output_filename, source_dir):
    """Pack a folder into an archive, compressed by gzip."""
    with tarfile.open(output_filename, "w:gz") as archive:
        archive.add(source_dir, arcname=os.path.basename(os.path.normpath(source_dir)))


def copy_file_or_folder(src, dst):
    """Copy a file, or a folder to a path that does not exist yet."""
    if os.path.isdir(src):
        shutil.copytree(src, dst)
    else:
        shutil.copy(src, dst)
