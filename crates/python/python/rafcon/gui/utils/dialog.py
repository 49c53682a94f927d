"""Dialogs of old scripts, as questions of the run: they ask wherever somebody watches it, without a desktop."""

import html
import re

from rafcon import dialog

#: Response of a message dialog, as in ``Gtk.ResponseType``.
_OK = -5


class _Dialog:
    """A window that is a question; ``run`` asks it and returns the number of the button, from 1."""

    def __init__(self, markup_text="", button_texts=(), title=None, **_looks):
        title, text = _plain(title), _plain(markup_text)
        self._message = f"{title}\n{text}" if title and title != text else text
        self._buttons = list(button_texts)
        self._response = None

    def run(self):
        """Asks, and waits for the answer."""
        self._response = None
        pressed = self._ask()
        return pressed + 1 if self._response is None else self._response

    def _ask(self):
        return dialog.ask(self._message, self._buttons).button

    def response(self, response_id):
        """Answers for the user."""
        self._response = response_id

    def connect(self, _signal, _function, *_arguments):
        """Signals of windows (keys, clicks) never come."""
        return 0

    def show_all(self):
        """Nothing to show before it asks."""

    def destroy(self):
        """Nothing to take away."""


class RAFCONButtonDialog(_Dialog):
    """A text and buttons."""


class RAFCONMessageDialog(_Dialog):
    """A text to be confirmed."""

    def __init__(self, markup_text="", **looks):
        _Dialog.__init__(self, markup_text, ["OK"], **looks)

    def run(self):
        """Asks, and waits for the answer."""
        _Dialog.run(self)
        return _OK


class RAFCONInputDialog(_Dialog):
    """A text, a line to fill in, buttons, and a box to tick if it has a label: that is a question of its own."""

    def __init__(self, markup_text="", button_texts=(), checkbox_text=None, **looks):
        _Dialog.__init__(self, markup_text, button_texts, **looks)
        self._box = checkbox_text
        self._entered, self._ticked = "", False

    def _ask(self):
        answer = dialog.text(self._message, buttons=self._buttons)
        self._entered = answer.text
        if self._box:
            self._ticked = dialog.checks(self._message, [self._box], buttons=["OK"]).checked[0]
        return answer.button

    def get_entry_text(self):
        """What was filled in."""
        return self._entered

    def get_checkbox_state(self):
        """Whether the box was ticked."""
        return self._ticked


class RAFCONColumnCheckboxDialog(_Dialog):
    """A text, boxes to tick, and buttons."""

    def __init__(self, markup_text="", button_texts=(), checkbox_texts=(), **looks):
        _Dialog.__init__(self, markup_text, button_texts, **looks)
        self._boxes = list(checkbox_texts)
        self._checked = [False] * len(self._boxes)

    def _ask(self):
        answer = dialog.checks(self._message, self._boxes, buttons=self._buttons)
        self._checked = list(answer.checked)
        return answer.button

    def get_checkbox_states(self):
        """Which were ticked, in the order of the boxes."""
        return self._checked


def get_root_window():
    """There is no window."""
    return None


def _plain(markup):
    """A text without the marks of the desktop's text format."""
    return html.unescape(re.sub(r"</?[a-zA-Z][^<>]*>", "", str(markup or "")))
