"""Lookup of libraries below the library roots."""

import os

from rafcon import _ids
from rafcon._bridge import native
from rafcon.core.config import global_config
from rafcon.core.custom_exceptions import LibraryNotFoundException
from rafcon.design_patterns.observer.observable import Observable

_MACHINE_FILE = "statemachine.json"
#: The library roots of an installed reference, below ``RAFCON_LIB_PATH``.
_USUAL = {
    "generic": ["generic"],
    "tutorials": ["..", "examples", "tutorials"],
    "ros": ["..", "examples", "libraries", "ros_libraries"],
    "ros2": ["..", "examples", "ros2_libraries"],
    "turtle_libraries": ["..", "examples", "libraries", "turtle_libraries"],
    "advanced_examples": ["..", "examples", "advanced_examples"],
}


class LibraryManager(Observable):
    """Library roots: folders that contain state machines, each under a key.

    Each library is read once, for all states that refer to it, until ``initialize`` is called
    again.
    """

    def __init__(self):
        self._known = None

    @staticmethod
    def instance(*arguments, **named):
        """Manager of this process; arguments have no effect."""
        from rafcon.core.singleton import library_manager

        return library_manager

    def initialize(self):
        """Forget the libraries that were read, so that they are read again on their next use."""
        self._known = None

    clean_loaded_libraries = initialize

    @Observable.observed
    def refresh_libraries(self):
        """Equivalent to ``initialize``."""
        self.initialize()

    def _roots(self):
        """Roots for the compiled module, with the libraries that it has read."""
        roots = tuple(self.library_root_paths.items())
        if self._known is None or self._known[0] != roots:
            self._known = roots, native.LibraryRoots(list(roots))
        return self._known[1]

    def _document(self, library_path, library_name, version, named):
        """Create a standalone library state; return its document and id.

        ``named`` is the state's name and its id, or None for each.
        """
        self.get_os_path_to_library(library_path, library_name)
        name, state_id = named
        state_id = _ids.state_id() if state_id is None else state_id
        version = None if version is None else str(version)
        reference = (library_path, library_name)
        return native.Document.library(self._roots(), reference, version, (state_id, None if name is None else str(name))), state_id

    def get_library_instance(self, library_path, library_name):
        """Create a :class:`~rafcon.core.states.library_state.LibraryState` for a library."""
        from rafcon.core.states.library_state import LibraryState

        return LibraryState(library_path, library_name)

    @property
    def library_root_paths(self):
        """Key to absolute folder: roots of ``RAFCON_LIBRARY_PATH`` and of the configuration.

        If no root of the configuration exists, the usual ones below ``RAFCON_LIB_PATH`` replace
        them.
        """
        folders = map(_absolute, filter(None, os.environ.get("RAFCON_LIBRARY_PATH", "").split(os.pathsep)))
        roots = {os.path.basename(folder): folder for folder in folders}
        configured = _folders(global_config.get_config_value("LIBRARY_PATHS"))
        roots.update(configured or _folders(_usual()))
        return {key: folder for key, folder in roots.items() if os.path.isdir(folder)}

    @property
    def libraries(self):
        """Nested dictionaries: root key to folders, and in these library name to absolute path."""
        return {key: _tree(folder) for key, folder in self.library_root_paths.items()}

    def get_os_path_to_library(self, library_path, library_name, allow_user_interaction=True):
        """Folder of a library, with its path and name.

        Raises ``LibraryNotFoundException`` if the library is missing. Never asks the user.
        """
        root, *folders = library_path.split("/")
        if "" in folders or root not in self.library_root_paths:
            raise LibraryNotFoundException(f"there is no library root for `{library_path}`")
        folder = os.path.join(self.library_root_paths[root], *folders, library_name)
        if not os.path.isfile(os.path.join(folder, _MACHINE_FILE)):
            raise LibraryNotFoundException(f"`{library_path}` has no library named `{library_name}`")
        return folder, library_path, library_name

    def is_library_in_libraries(self, library_path, library_name):
        """True if the library exists."""
        try:
            self.get_os_path_to_library(library_path, library_name)
        except LibraryNotFoundException:
            return False
        return True

    def get_library_path_and_name_for_os_path(self, path):
        """Library path and name of a folder; (None, None) if it is not below a root."""
        path = _absolute(path)
        for key, root in self.library_root_paths.items():
            if path != root and os.path.commonpath([root, path]) == root:
                folder, name = os.path.split(os.path.relpath(path, root))
                return "/".join([key, *filter(None, folder.split(os.sep))]), name
        return None, None

    def is_os_path_within_library_root_paths(self, path):
        """True if a folder is below a root."""
        return self.get_library_path_and_name_for_os_path(path) != (None, None)


def _usual():
    base = os.environ.get("RAFCON_LIB_PATH")
    return {key: os.path.join(base, *below) for key, below in _USUAL.items()} if base else {}


def _folders(paths):
    """Keep the folders that exist, as absolute paths."""
    folders = {key: _absolute(folder) for key, folder in paths.items()}
    return {key: folder for key, folder in folders.items() if os.path.isdir(folder)}


def _absolute(folder):
    return os.path.realpath(os.path.expandvars(os.path.expanduser(str(folder).strip("'\""))))


def _tree(folder):
    found = {}
    for entry in sorted(os.scandir(folder), key=lambda entry: entry.name):
        if entry.name.startswith(".") or not entry.is_dir():
            continue
        is_library = os.path.isfile(os.path.join(entry.path, _MACHINE_FILE))
        found[entry.name] = entry.path if is_library else _tree(entry.path)
    return found
