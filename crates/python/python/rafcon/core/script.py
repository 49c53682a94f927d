"""The script of an execution state."""

import io
import os
import tokenize

#: Script of a new state.
DEFAULT_SCRIPT = """
def execute(self, inputs, outputs, gvm):
    self.logger.info("Hello {}".format(self.name))
    self.preemptive_wait(2)
    return "success"
"""
#: The name of the file in a state's folder.
SCRIPT_FILE = "script.py"


def _decoded(source):
    """The text of a source file in UTF-8, or in the encoding that it declares."""
    try:
        text = source.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = source.decode(tokenize.detect_encoding(io.BytesIO(source).readline)[0])
    return io.IncrementalNewlineDecoder(None, translate=True).decode(text)


class Script:
    """The text of a script, and where it lies: that of a state, or one that a state may get by ``state.script = …``.

    One that is made has the text of the file ``filename`` in the folder ``path``, or that of a new state.
    """

    def __init__(self, path=None, filename=None, parent=None):
        self._path, self._filename, self._parent = path, filename or SCRIPT_FILE, parent
        self._state = None
        self._text = DEFAULT_SCRIPT
        if path is not None:
            self.load_script()

    def _belong_to(self, state):
        """From now on it is the script of a state, with the state's text."""
        self._state = self._parent = state
        return self

    @property
    def script(self):
        """The text (``str``), or None where there is no file."""
        return self._text if self._state is None else self._state.script_text

    @script.setter
    def script(self, text):
        if self._state is None:
            self._text = text
        else:
            self._state.script_text = text

    def set_script_without_compilation(self, text):
        """The same as assigning ``script``."""
        self.script = text

    def load_script(self, path=None, filename=None):
        """Takes the text of a file over; without arguments, that of its own file."""
        path = self.path if path is None else path
        with open(os.path.join(path, filename or self.filename), "rb") as file:
            self.script = _decoded(file.read())

    def compile_module(self):
        """Raises what Python says against the text, if anything."""
        compile(self.script or "", os.path.join(self.path or "", self.filename), "exec")

    @property
    def path(self):
        """The folder (``str``) of the script."""
        return self._path if self._state is None else self._state.file_system_path

    @property
    def filename(self):
        """The name of the file; ``script.py`` for that of a state."""
        return self._filename if self._state is None else SCRIPT_FILE

    @property
    def parent(self):
        """The state, or None."""
        return self._parent
