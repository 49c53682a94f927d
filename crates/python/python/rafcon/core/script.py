"""The script of an execution state."""

from rafcon.core._refusals import NoConstructor, fixed, refuses


@refuses("load_script", "set_script_without_compilation")
class Script(NoConstructor):
    """The text of a state's script, and where it lies."""

    def _bind(self, state):
        self._state = state

    @fixed
    def script(self):
        """The text (``str``), or None where there is no file."""
        return self._state._facts["script"]

    @fixed
    def path(self):
        """The folder (``str``) of the script."""
        return self._state.file_system_path

    @fixed
    def filename(self):
        """The name of the file, always ``script.py``."""
        return "script.py"

    @property
    def parent(self):
        """The state."""
        return self._state
