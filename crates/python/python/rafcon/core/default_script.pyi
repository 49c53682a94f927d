from typing import Any

from rafcon.core.global_variable_manager import GlobalVariableManager
from rafcon.core.states.execution_state import ExecutionState

def execute(self: ExecutionState, inputs: dict[str, Any], outputs: dict[str, Any], gvm: GlobalVariableManager) -> str: ...
