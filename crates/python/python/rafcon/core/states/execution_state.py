"""States that run a script."""

from functools import cached_property

from rafcon.core.script import DEFAULT_SCRIPT, Script
from rafcon.core.states.state import State


class ExecutionState(State):
    """State whose ``execute`` function is called on entry.

    By default its script logs a greeting, waits for two seconds and leaves by *success*. ``path``
    and ``filename`` may name a file with another script.
    """

    _kind = "execution"

    def __init__(
        self,
        name=None,
        state_id=None,
        input_data_ports=None,
        output_data_ports=None,
        income=None,
        outcomes=None,
        path=None,
        filename=None,
        check_path=True,
        safe_init=True,
    ):
        self._build(name, state_id, (input_data_ports, output_data_ports, outcomes))
        self.script_text = DEFAULT_SCRIPT
        if path is not None:
            self.script.load_script(path, filename)

    @cached_property
    def _own_script(self):
        return Script()._belong_to(self)

    @property
    def script(self):
        """:class:`Script` of the state. Assigning another one sets the state's text."""
        return self._own_script

    @script.setter
    def script(self, script):
        if not isinstance(script, Script):
            raise TypeError(f"a Script is expected, not {type(script).__name__}")
        self.script_text = script.script
        self._own_script = script._belong_to(self)

    # Old name, for existing programs.
    _script = script

    @property
    def script_text(self):
        """Text (``str``) of the script. A new text takes effect at the next entry of the state."""
        return self._facts["script"]

    @script_text.setter
    def script_text(self, text):
        if text is not None and not isinstance(text, str):
            raise ValueError(f"a script must be a str, not {type(text).__name__}")
        self._change("state.script", text)
