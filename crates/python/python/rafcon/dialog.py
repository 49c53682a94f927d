"""Questions of a state to people, answered where the run is watched: in the terminal, in a browser.

    from rafcon import dialog

    def execute(self, inputs, outputs, gvm):
        answer = dialog.ask("Is the gripper empty?", ["yes", "no"], timeout=60, default="no")
        return "success" if answer.label == "yes" else "retry"

Each function asks, waits until the question is closed, and returns the answer. ``timeout`` is in
seconds. When it expires, the result is ``default``; without a default, ``TimeoutError`` is raised.
``lost_link`` (s) closes a question in this manner, too, once the ground has been silent for that
time. If the state is preempted, or the run stopped,
:class:`~rafcon.core.custom_exceptions.StatePreempted` is raised and the state leaves by
*preempted*. A state that is already preempted cannot ask.

A question is asked on the thread of the script. It stays open if no person is connected.
"""

import json
from dataclasses import dataclass

from rafcon._bridge import native
from rafcon._capture import flush_capture
from rafcon.core.custom_exceptions import StatePreempted

__all__ = ["Checks", "Number", "Pressed", "Text", "ask", "checks", "number", "text"]

_OK_CANCEL = ("OK", "Cancel")


@dataclass(frozen=True)
class Pressed:
    """Answer of :func:`ask`; base class of the other ones."""

    #: The button: its index, from 0.
    button: int
    #: The button's label.
    label: str
    #: True if nobody answered in time, so that this is the default.
    timed_out: bool


@dataclass(frozen=True)
class Text(Pressed):
    """Answer of :func:`text`."""

    #: Content of the line.
    text: str


@dataclass(frozen=True)
class Number(Pressed):
    """Answer of :func:`number`."""

    #: An ``int`` if whole numbers were requested, else a ``float``.
    number: float


@dataclass(frozen=True)
class Checks(Pressed):
    """Answer of :func:`checks`."""

    #: One value for each box, in order.
    checked: tuple


def ask(message, buttons=("OK",), timeout=None, default=None, lost_link=None):
    """Ask for one of several buttons; return :class:`Pressed`.

    ``default`` is the label or the index of a button.
    """
    buttons = _labels(buttons)
    form = {"type": "buttons", "buttons": buttons}
    answer = None if default is None else {"button": _index(buttons, default)}
    button, label, timed_out, _answer = _asked(message, form, (timeout, lost_link), answer)
    return Pressed(button, label, timed_out)


def text(message, initial="", buttons=_OK_CANCEL, timeout=None, default=None, lost_link=None):
    """Ask for a line of text; return :class:`Text`. ``default`` is a text for the first button."""
    form = {"type": "text", "buttons": _labels(buttons), "initial": str(initial)}
    answer = None if default is None else {"button": 0, "text": str(default)}
    button, label, timed_out, answer = _asked(message, form, (timeout, lost_link), answer)
    return Text(button, label, timed_out, answer["text"])


def number(
    message, minimum=None, maximum=None, initial=None, whole=False, buttons=_OK_CANCEL, timeout=None, default=None, lost_link=None
):
    """Ask for a number from ``minimum`` to ``maximum``; return :class:`Number`.

    ``default`` is a number, with the first button. With ``whole``, only whole numbers are accepted.
    """
    form = {
        "type": "number",
        "buttons": _labels(buttons),
        "minimum": minimum,
        "maximum": maximum,
        "initial": initial,
        "whole": bool(whole),
    }
    answer = None if default is None else {"button": 0, "number": default}
    button, label, timed_out, answer = _asked(message, form, (timeout, lost_link), answer)
    return Number(button, label, timed_out, int(answer["number"]) if whole else float(answer["number"]))


def checks(message, boxes, initial=(), buttons=_OK_CANCEL, timeout=None, default=None, lost_link=None):
    """Ask which boxes to tick; return :class:`Checks`.

    ``initial`` and ``default`` have one truth value for each box. ``default`` has the first button.
    """
    boxes = _labels(boxes)
    form = {"type": "checks", "buttons": _labels(buttons), "boxes": boxes, "initial": _truths(initial)}
    answer = None if default is None else {"button": 0, "checked": _truths(default)}
    button, label, timed_out, answer = _asked(message, form, (timeout, lost_link), answer)
    return Checks(button, label, timed_out, tuple(answer["checked"]))


def _asked(message, form, times, default):
    """Ask; return the button's index and label, whether the timeout expired, and the answer."""
    flush_capture()
    timeout, lost_link = times
    timeout_ms, lost_link_ms = (None if time is None else max(round(float(time) * 1000), 0) for time in times)
    default = None if default is None else json.dumps(default)
    how, answer = native.ask(str(message), json.dumps(form), (timeout_ms, lost_link_ms), default)
    if how == "withdrawn":
        raise StatePreempted("preempted while a question was open")
    if answer is None:
        limits = [f"within {timeout} s"] if timeout is not None else []
        limits += [f"before the ground was silent for {lost_link} s"] if lost_link is not None else []
        raise TimeoutError(f"nobody answered {' or '.join(limits)}: {message}")
    answer = json.loads(answer)
    return answer["button"], form["buttons"][answer["button"]], how == "timed_out", answer


def _labels(labels):
    if isinstance(labels, str):
        raise TypeError(f"a list of labels is needed, not the text {labels!r}")
    return [str(label) for label in labels]


def _truths(truths):
    return [bool(truth) for truth in truths]


def _index(buttons, wanted):
    if isinstance(wanted, int):
        return wanted
    if wanted not in buttons:
        raise ValueError(f"the default {wanted!r} is none of the buttons {buttons}")
    return buttons.index(wanted)
