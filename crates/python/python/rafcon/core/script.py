"""The script of an execution state."""

import os

#: What a new state does.
DEFAULT_SCRIPT = """
def execute(self, inputs, outputs, gvm):
    self.logger.info("Hello {}".format(self.name))
    self.preemptive_wait(2)
    return "success"
"""
#: The name of the file in a state's folder.
SCRIPT_FILE = "script.py"


class Script:
    """The text of a state's script, and where it lies."""

    def __init__(self, state):
        self._state = state

    @property
    def script(self):
        """The text (``str``), or None where there is no file."""
        return self._state.script_text

    @script.setter
    def script(self, text):
        self._state.script_text = text

    def set_script_without_compilation(self, text):
        """The same as assigning ``script``."""
        self._state.script_text = text

    def load_script(self, path=None, filename=None):
        """Takes the text of a file over; without arguments, that of the state's own file."""
        path = self.path if path is None else path
        with open(os.path.join(path, filename or SCRIPT_FILE), encoding="utf-8") as file:
            self._state.script_text = file.read()

    def compile_module(self):
        """Raises what Python says against the text, if anything."""
        compile(self.script or "", os.path.join(self.path or "", SCRIPT_FILE), "exec")

    @property
    def path(self):
        """The folder (``str``) of the script."""
        return self._state.file_system_path

    @property
    def filename(self):
        """The name of the file, always ``script.py``."""
        return SCRIPT_FILE

    @property
    def parent(self):
        """The state."""
        return self._state
