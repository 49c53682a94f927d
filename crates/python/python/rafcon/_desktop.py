"""What dialog scripts of old find where they look for a desktop: dialogs that are questions of the run.

Only scripts that import ``rafcon.gui.utils.dialog`` get it, whether a desktop is installed or not: without its main
loop, which a run has not, they would wait for ever. Everything else that looks for a desktop finds what there is.
"""

import builtins
import html
import os
import re
import types

from rafcon import dialog

#: The answers of ``Gtk.ResponseType`` that the dialogs give.
_OK = -5

_DIALOGS = "rafcon.gui.utils.dialog"


class _Constants:
    """Names of a toolkit that only choose how a window looks: each is its own name."""

    def __init__(self, name):
        self._name = name

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return _Constants(f"{self._name}.{name}")

    def __or__(self, other):
        return self

    def __repr__(self):
        return self._name


class _Responses(_Constants):
    OK = _OK


class _GLib:
    """Calls at once what wants to be called on the thread of the desktop."""

    @staticmethod
    def idle_add(function, *arguments, **_priority):
        """Calls the function; 0 stands for the number of a source that is gone."""
        function(*arguments)
        return 0


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


def _modules():
    gtk = types.SimpleNamespace(
        DialogFlags=_Constants("DialogFlags"),
        MessageType=_Constants("MessageType"),
        ResponseType=_Responses("ResponseType"),
    )
    gdk = types.SimpleNamespace(keyval_name=lambda _number: "")
    repository = types.SimpleNamespace(GLib=_GLib, Gtk=gtk, Gdk=gdk)
    dialogs = types.SimpleNamespace(
        RAFCONButtonDialog=RAFCONButtonDialog,
        RAFCONColumnCheckboxDialog=RAFCONColumnCheckboxDialog,
        RAFCONInputDialog=RAFCONInputDialog,
        RAFCONMessageDialog=RAFCONMessageDialog,
        get_root_window=get_root_window,
    )
    return {"gi.repository": repository, _DIALOGS: dialogs}


def builtins_with_dialogs():
    """The built-in names for such a script: ``import`` finds the dialogs of this module.

    With ``RAFCON_DIALOGS=missing`` in the environment it finds what there is, so that such scripts take the way that
    they have for a machine without a desktop.
    """
    if os.environ.get("RAFCON_DIALOGS") == "missing":
        return builtins.__dict__
    modules = _modules()

    def find(name, module=None, local_names=None, wanted=(), level=0):
        if level == 0 and wanted and name in modules:
            return modules[name]
        return builtins.__import__(name, module, local_names, wanted, level)

    return {**builtins.__dict__, "__import__": find}
