"""Questions of a state to people, answered wherever somebody watches the run: in the terminal, in a browser.

    from rafcon import dialog

    def execute(self, inputs, outputs, gvm):
        answer = dialog.ask("Is the gripper empty?", ["yes", "no"], timeout=60, default="no")
        return "success" if answer.label == "yes" else "retry"

Each function asks, waits for the end of the question, and returns what was answered. ``timeout`` is in seconds. When
the time is over the ``default`` counts; without one, ``TimeoutError`` is raised. ``lost_link`` is a time in seconds,
too: the question also ends so once the ground was not heard for that long. If the state is preempted, or the run
stopped, :class:`~rafcon.core.custom_exceptions.StatePreempted` is raised and the state leaves by *preempted*; a state
that is preempted already cannot ask.

A question is asked on the thread of the script. Nobody need be connected: it stays open until somebody is.
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
    """The answer of :func:`ask`, and what the other answers have in common."""

    #: The button: its index, from 0.
    button: int
    #: The button's label.
    label: str
    #: True if nobody answered in time, so that this is the default.
    timed_out: bool


@dataclass(frozen=True)
class Text(Pressed):
    """The answer of :func:`text`."""

    #: Content of the line.
    text: str


@dataclass(frozen=True)
class Number(Pressed):
    """The answer of :func:`number`."""

    #: An ``int`` if whole numbers were requested, else a ``float``.
    number: float


@dataclass(frozen=True)
class Checks(Pressed):
    """The answer of :func:`checks`."""

    #: One value for each box, in order.
    checked: tuple


def ask(message, buttons=("OK",), timeout=None, default=None, lost_link=None):
    """Asks for one of some buttons; returns :class:`Pressed`. ``default`` is the label or the index of a button."""
    buttons = _labels(buttons)
    form = {"type": "buttons", "buttons": buttons}
    answer = None if default is None else {"button": _index(buttons, default)}
    button, label, timed_out, _answer = _asked(message, form, (timeout, lost_link), answer)
    return Pressed(button, label, timed_out)


def text(message, initial="", buttons=_OK_CANCEL, timeout=None, default=None, lost_link=None):
    """Asks for a line of text; returns :class:`Text`. ``default`` is a text, with the first button."""
    form = {"type": "text", "buttons": _labels(buttons), "initial": str(initial)}
    answer = None if default is None else {"button": 0, "text": str(default)}
    button, label, timed_out, answer = _asked(message, form, (timeout, lost_link), answer)
    return Text(button, label, timed_out, answer["text"])


def number(
    message, minimum=None, maximum=None, initial=None, whole=False, buttons=_OK_CANCEL, timeout=None, default=None, lost_link=None
):
    """Asks for a number from ``minimum`` to ``maximum``; returns :class:`Number`.

    ``default`` is a number, with the first button. Only whole numbers are taken if ``whole`` is set.
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
    """Asks which boxes to tick; returns :class:`Checks`.

    ``initial`` and ``default`` are truths, one for each box; ``default`` counts with the first button.
    """
    boxes = _labels(boxes)
    form = {"type": "checks", "buttons": _labels(buttons), "boxes": boxes, "initial": _truths(initial)}
    answer = None if default is None else {"button": 0, "checked": _truths(default)}
    button, label, timed_out, answer = _asked(message, form, (timeout, lost_link), answer)
    return Checks(button, label, timed_out, tuple(answer["checked"]))


def _asked(message, form, times, default):
    """(index of the button, its label, whether the time was over, the answer)."""
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
