from collections.abc import Iterable, Mapping
from os import PathLike

from rafcon.core.script import Script
from rafcon.core.state_elements.data_port import InputDataPort, OutputDataPort
from rafcon.core.state_elements.logical_port import Income, Outcome
from rafcon.core.states.state import State

class ExecutionState(State):
    def __init__(
        self,
        name: str | None = None,
        state_id: str | None = None,
        input_data_ports: Mapping[int, InputDataPort] | Iterable[InputDataPort] | None = None,
        output_data_ports: Mapping[int, OutputDataPort] | Iterable[OutputDataPort] | None = None,
        income: Income | None = None,
        outcomes: Mapping[int, Outcome] | Iterable[Outcome] | None = None,
        path: str | PathLike[str] | None = None,
        filename: str | None = None,
        check_path: bool = True,
        safe_init: bool = True,
    ) -> None: ...
    @property
    def script(self) -> Script: ...
    @script.setter
    def script(self, script: Script) -> None: ...
    @property
    def script_text(self) -> str | None: ...
    @script_text.setter
    def script_text(self, text: str | None) -> None: ...
