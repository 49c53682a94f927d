from collections.abc import Sequence

def open_folder_cmd_line(query: str, default_path: str | None = None) -> str | None: ...
def create_folder_cmd_line(
    query: str, default_name: str | None = None, default_path: str | None = None
) -> str | None: ...
def save_folder_cmd_line(
    query: str, default_name: str | None = None, default_path: str | None = None
) -> str | None: ...
def show_notice(notice: str, custom_buttons: Sequence[str] | None = None) -> None: ...

open_folder_func = open_folder_cmd_line
create_folder_func = create_folder_cmd_line
save_folder_func = save_folder_cmd_line
show_notice_func = show_notice
