"""Tracebacks for users, without the frames of the caller of the script."""

import traceback

#: Maximum number of shown frames of a traceback.
_FRAMES_MAX = 40


def format_error(error, filename):
    """Traceback of an exception that a script raised, from the script's first frame on.

    ``filename`` is the file name that the script was compiled with. An exception outside the
    script, such as a syntax error or a missing ``execute``, is shown without frames.
    """
    shown = traceback.TracebackException(
        type(error), error, _script_part(error.__traceback__, filename), limit=-_FRAMES_MAX
    )
    return "".join(shown.format()).rstrip("\n")


def _script_part(frames, filename):
    while frames is not None and frames.tb_frame.f_code.co_filename != filename:
        frames = frames.tb_next
    return frames
