"""States that run a script."""

from functools import cached_property

from rafcon.core._refusals import fixed
from rafcon.core.script import Script
from rafcon.core.states.state import State


class ExecutionState(State):
    """A state whose ``execute`` function is called when it is entered."""

    @cached_property
    def _script(self):
        script = Script.__new__(Script)
        script._bind(self)
        return script

    @fixed
    def script(self):
        """The :class:`Script`."""
        return self._script

    @fixed
    def script_text(self):
        """The script's text (``str``)."""
        return self._facts["script"]
