from collections.abc import Mapping, Sequence
from logging import Logger
from typing import Any

logger: Logger

def log_to_raw_structure(execution_history_items: Mapping[str, Any]) -> Any: ...
def log_to_collapsed_structure(
    execution_history_items: Mapping[str, Any],
    throw_on_pickle_error: bool = True,
    include_erroneous_data_ports: bool = False,
    full_next: bool = False,
) -> Any: ...
def log_to_DataFrame(
    execution_history_items: Mapping[str, Any],
    data_in_columns: Sequence[str] = (),
    data_out_columns: Sequence[str] = (),
    scoped_in_columns: Sequence[str] = (),
    scoped_out_columns: Sequence[str] = (),
    semantic_data_columns: Sequence[str] = (),
    throw_on_pickle_error: bool = True,
) -> Any: ...
