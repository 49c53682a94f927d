"""Dialogs of old scripts as questions of the run, answered where the run is watched."""

import html
import re

from rafcon import dialog

#: Response of a message dialog, as in ``Gtk.ResponseType``.
_OK = -5


class _Dialog:
    """Dialog that is a question; ``run`` asks it and returns the number of the button, from 1."""

    def __init__(self, markup_text="", button_texts=(), title=None, **_looks):
        title, text = _plain(title), _plain(markup_text)
        self._message = f"{title}\n{text}" if title and title != text else text
        self._buttons = list(button_texts)
        self._response = None

    def run(self):
        """Ask, and wait for the answer."""
        self._response = None
        pressed = self._ask()
        return pressed + 1 if self._response is None else self._response

    def _ask(self):
        return dialog.ask(self._message, self._buttons).button

    def response(self, response_id):
        """Set the result of ``run`` on behalf of the user."""
        self._response = response_id

    def connect(self, _signal, _function, *_arguments):
        """Ignore the function: signals of windows (keys, clicks) never occur."""
        return 0

    def show_all(self):
        """Do nothing: only ``run`` shows the question."""

    def destroy(self):
        """Do nothing: there is no window."""


class RAFCONButtonDialog(_Dialog):
    """Text with buttons."""


class RAFCONMessageDialog(_Dialog):
    """Text with a button OK."""

    def __init__(self, markup_text="", **looks):
        _Dialog.__init__(self, markup_text, ["OK"], **looks)

    def run(self):
        """Ask, and wait for the answer."""
        _Dialog.run(self)
        return _OK


class RAFCONInputDialog(_Dialog):
    """Text with an input line and buttons. A labelled checkbox is a second question."""

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
        """Text that was entered."""
        return self._entered

    def get_checkbox_state(self):
        """True if the box was ticked."""
        return self._ticked


class RAFCONColumnCheckboxDialog(_Dialog):
    """Text with checkboxes and buttons."""

    def __init__(self, markup_text="", button_texts=(), checkbox_texts=(), **looks):
        _Dialog.__init__(self, markup_text, button_texts, **looks)
        self._boxes = list(checkbox_texts)
        self._checked = [False] * len(self._boxes)

    def _ask(self):
        answer = dialog.checks(self._message, self._boxes, buttons=self._buttons)
        self._checked = list(answer.checked)
        return answer.button

    def get_checkbox_states(self):
        """State of each box, in order."""
        return self._checked


def get_root_window():
    """Return None: there is no window."""
    return None


def _plain(markup):
    """Remove the markup of the desktop's text format."""
    return html.unescape(re.sub(r"</?[a-zA-Z][^<>]*>", "", str(markup or "")))
