"""Script of an execution state."""

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
    """Decode a source file: UTF-8, or the encoding that it declares."""
    try:
        text = source.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = source.decode(tokenize.detect_encoding(io.BytesIO(source).readline)[0])
    return io.IncrementalNewlineDecoder(None, translate=True).decode(text)


class Script:
    """Text and file of a script: that of a state, or one to assign with ``state.script = …``.

    A new one has the text of the file ``filename`` in the folder ``path``; without ``path``, the
    script of a new state.
    """

    def __init__(self, path=None, filename=None, parent=None):
        self._path, self._filename, self._parent = path, filename or SCRIPT_FILE, parent
        self._state = None
        self._text = DEFAULT_SCRIPT
        if path is not None:
            self.load_script()

    def _belong_to(self, state):
        """Make this the script of a state, with the state's text."""
        self._state = self._parent = state
        return self

    @property
    def script(self):
        """Text (``str``), or None if there is no file."""
        return self._text if self._state is None else self._state.script_text

    @script.setter
    def script(self, text):
        if self._state is None:
            self._text = text
        else:
            self._state.script_text = text

    def set_script_without_compilation(self, text):
        """Equivalent to assigning ``script``."""
        self.script = text

    def load_script(self, path=None, filename=None):
        """Read the text from a file, by default the script's own."""
        path = self.path if path is None else path
        with open(os.path.join(path, filename or self.filename), "rb") as file:
            self.script = _decoded(file.read())

    def compile_module(self):
        """Compile the text; raises ``SyntaxError`` if it is invalid."""
        compile(self.script or "", os.path.join(self.path or "", self.filename), "exec")

    @property
    def path(self):
        """Folder (``str``) of the script."""
        return self._path if self._state is None else self._state.file_system_path

    @property
    def filename(self):
        """Name of the file; ``script.py`` for the script of a state."""
        return self._filename if self._state is None else SCRIPT_FILE

    @property
    def parent(self):
        """State of the script, or None."""
        return self._parent
