"""``input`` and debuggers in scripts: asked at the terminal of ``rafcon run``, else an error."""

import builtins
import os
import sys

from rafcon import _capture, dialog
from rafcon._bridge import native

#: Environment variable; not empty if people answer questions at the terminal of the starter.
_HAS_KEYS = "RAFCON_HAS_KEYS"
_ADVICE = (
    "nobody can type here: ask people by `rafcon.dialog.text`; to debug by `pdb`, run the machine by `rafcon run` in a "
    "terminal, or by `python3 -m rafcon.core.start -o FOLDER`"
)
_input = builtins.input
_has_terminal = False


def install():
    """Replace ``input``, which Python's debugger uses too."""
    global _has_terminal
    _has_terminal = bool(os.environ.pop(_HAS_KEYS, ""))
    builtins.input = _ask


def _ask(prompt="", /):
    if not getattr(sys.stdout, "is_captured", False):
        return _input(prompt)
    if _has_terminal and native.current_path() >= 0:
        return _ask_people(str(prompt))
    try:
        return _input(prompt)
    except EOFError:
        # The debugger interprets an EOFError as its command to quit.
        is_debugger = sys._getframe(1).f_globals.get("__name__") == "cmd"
        raise (RuntimeError if is_debugger else EOFError)(_ADVICE) from None


def _ask_people(prompt):
    _path, waiting = _capture.pending.pop(_capture.key_of("stdout"), (None, ""))
    prompt = waiting + prompt
    answer = dialog.text(prompt.strip() or "input", buttons=("OK",)).text
    sys.stdout.write(f"{prompt}{answer}\n")
    return answer
