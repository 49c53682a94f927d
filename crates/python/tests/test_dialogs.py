"""Questions to people: asked by scripts, answered by a viewer, by nobody, or not at all."""

import importlib.metadata
import os
import pathlib
import subprocess
import tempfile
import textwrap
import unittest

from support import Runner, container, run, save, script, sequence

REFERENCE = os.environ.get("RAFCON_REFERENCE_PYTHON")


def asking(body, **state):
    """A state that prints what ``answer`` is made of."""
    head = "from rafcon import dialog\ndef execute(self, inputs, outputs, gvm):\n"
    return script(head + textwrap.indent(textwrap.dedent(body).strip("\n"), "    ") + "\n", **state)


class Dialogs(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def start(self, root, **options):
        return Runner(save(self.folder / "machine", root), **options)

    def check(self, call, form, answer, printed, outcome="success"):
        """A script makes a call; somebody answers it."""
        runner = self.start(sequence(asking("print(%s)\nreturn 0" % call)))
        question = runner.answer(**answer)
        result = runner.finish()
        self.assertEqual(question["form"], form)
        self.assertEqual((question["path"], question["message"]), ("R/A", "Ready?"))
        self.assertEqual(result.logged("stdout"), [printed] if printed else [])
        self.assertEqual(result.outcome, outcome)
        return result

    def test_buttons(self):
        self.check(
            'dialog.ask("Ready?", ["yes", "no"])',
            {"type": "buttons", "buttons": ["yes", "no"]},
            {"button": 1},
            "Pressed(button=1, label='no', timed_out=False)",
        )

    def test_a_text(self):
        self.check(
            'dialog.text("Ready?", initial="x")',
            {"type": "text", "buttons": ["OK", "Cancel"], "initial": "x"},
            {"button": 0, "text": "grün"},
            "Text(button=0, label='OK', timed_out=False, text='grün')",
        )

    def test_a_number(self):
        form = {"type": "number", "buttons": ["OK", "Cancel"], "minimum": 0.0, "maximum": 9.0, "initial": None}
        self.check(
            'dialog.number("Ready?", 0, 9, whole=True)',
            {**form, "whole": True},
            {"button": 0, "number": 3},
            "Number(button=0, label='OK', timed_out=False, number=3)",
        )

    def test_boxes(self):
        self.check(
            'dialog.checks("Ready?", ["a", "b"], initial=[True, False], buttons=["go"])',
            {"type": "checks", "buttons": ["go"], "boxes": ["a", "b"], "initial": [True, False]},
            {"button": 0, "checked": [False, True]},
            "Checks(button=0, label='go', timed_out=False, checked=(False, True))",
        )

    def test_an_answer_that_does_not_fit_is_refused_and_the_question_stays_open(self):
        runner = self.start(sequence(asking('print(dialog.number("n", 0, 9).number)\nreturn 0')))
        question = runner.question()
        for number, value in ((1, 12), (2, 5)):
            command = {"type": "answer_question", "question": question["id"], "value": {"button": 0, "number": value}}
            runner.send({"message": "command", "id": str(number), "command": command})
        result = runner.finish()
        answers = [message for message in result.messages if message["message"] == "answer"]
        self.assertEqual([answer["answer"] for answer in answers], ["refused", "applied"])
        self.assertEqual(result.logged("stdout"), ["5.0"])

    def test_when_the_time_is_over_the_default_counts(self):
        result = run(
            save(
                self.folder / "machine",
                sequence(asking('print(dialog.ask("?", ["yes", "no"], timeout=0, default="no"))\nreturn 0')),
            )
        )
        self.assertEqual(result.logged("stdout"), ["Pressed(button=1, label='no', timed_out=True)"])
        closed = [event for event in result.events if event["type"] == "closed"]
        self.assertEqual([event["how"] for event in closed], ["timed_out"])

    def test_without_a_default_it_is_a_timeout_error(self):
        result = run(save(self.folder / "machine", sequence(asking('dialog.ask("?", timeout=0)\nreturn 0'))))
        self.assertEqual(result.outcome, "aborted")
        self.assertEqual(result.finished["outputs"]["error"]["__exc__"], "TimeoutError")

    def test_what_cannot_be_asked_is_an_error(self):
        for call in ('dialog.ask("?", [])', 'dialog.ask("?", "yes")', 'dialog.ask("?", ["a"], default="b")'):
            result = run(save(self.folder / call, sequence(asking(call + "\nreturn 0"))))
            self.assertEqual(result.outcome, "aborted", call)

    def test_a_stop_withdraws_it(self):
        runner = self.start(
            sequence(asking('try:\n    dialog.ask("?")\nfinally:\n    print("clean")\nreturn 0'))
        )
        runner.question()
        runner.command("stop")
        result = runner.finish()
        self.assertEqual(result.outcome, "preempted")
        self.assertEqual(result.logged("stdout"), ["clean"])
        self.assertEqual(result.logged(path="R/A"), ["clean"])

    def test_two_branches_ask_at_once(self):
        both = [asking('print(self.name, dialog.ask("?", ["x", "y"]).label)\nreturn 0', id=name) for name in "AB"]
        decider = script("def execute(self, i, o, g):\n    return 0\n", decider=True)
        runner = self.start(
            container("barrier", both + [decider], [(decider["id"], 0, 0)])
        )
        first, second = runner.question(), runner.question()
        for index, question in enumerate((second, first)):
            command = {"type": "answer_question", "question": question["id"], "value": {"button": index}}
            runner.send({"message": "command", "id": str(index), "command": command})
        result = runner.finish()
        labels = {second["path"]: "x", first["path"]: "y"}
        expected = sorted("%s %s" % (path[-1].lower(), label) for path, label in labels.items())
        self.assertEqual(sorted(result.logged("stdout")), expected)


OLD = """
from gi.repository import GLib
from gi.repository import Gtk
from rafcon.gui.utils.dialog import RAFCONButtonDialog, get_root_window

def execute(self, inputs, outputs, gvm):
    def show(event, result):
        window = RAFCONButtonDialog(markup_text="<b>a</b> &amp; b", button_texts=["x", "y"],
                                    flags=Gtk.DialogFlags.MODAL, parent=get_root_window())
        result[0] = window.run()
        window.destroy()
        event.set()

    event, result = self._preempted, [None]
    GLib.idle_add(show, event, result)
    event.wait()
    event.clear()
    print(result[0], self.preempted)
    return 0
"""


class DialogsOfTheDesktop(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_a_window_is_a_question(self):
        runner = Runner(save(self.folder / "m", sequence(script(OLD))))
        question = runner.answer(button=1)
        result = runner.finish()
        self.assertEqual((question["message"], question["form"]["buttons"]), ("a & b", ["x", "y"]))
        self.assertEqual((result.outcome, result.logged("stdout")), ("success", ["2 False"]))

    def check_import(self, text, helper=None):
        """A script with these imports asks by ``dialog.RAFCONMessageDialog``; another script finds no desktop."""
        if helper is not None:
            (self.folder / "helper.py").write_text(helper)
        head = f"import sys\nsys.path.insert(0, {str(self.folder)!r})\n{text}\n"
        asks = "def execute(self, inputs, outputs, gvm):\n    print(RAFCONMessageDialog('Go?').run())\n    return 0\n"
        looks = "def execute(self, inputs, outputs, gvm):\n    import gi.repository.NoSuchPart\n"
        machine = sequence(script(head + asks), script(looks, id="B"))
        runner = Runner(save(self.folder / "m", machine))
        question = runner.answer(button=0)
        result = runner.finish()
        self.assertEqual(question and question["message"], "Go?", result.logged())
        self.assertEqual(result.logged("stdout"), ["-5"])
        self.assertEqual(result.steps()[-2:], ["-R/B=aborted", "-R=aborted"])

    def test_every_spelling_of_the_import(self):
        for text in (
            "from rafcon.gui.utils import dialog\nRAFCONMessageDialog = dialog.RAFCONMessageDialog",
            "import rafcon.gui.utils.dialog as dialog\nRAFCONMessageDialog = dialog.RAFCONMessageDialog",
            "import rafcon.gui.utils.dialog\nRAFCONMessageDialog = rafcon.gui.utils.dialog.RAFCONMessageDialog",
            "from rafcon.gui.utils import (\n    wait_for_gui,\n    dialog as d,\n)\nRAFCONMessageDialog = d.RAFCONMessageDialog",
            "import gi\ngi.require_version('Gtk', '3.0')\nfrom rafcon.gui.utils.dialog import RAFCONMessageDialog",
            "import importlib\ndialog = importlib.import_module('rafcon.gui.utils.dialog')\n"
            "RAFCONMessageDialog = dialog.RAFCONMessageDialog",
        ):
            with self.subTest(text):
                self.setUp()
                self.check_import(text)

    def test_a_module_that_a_script_imports_asks(self):
        helper = "from gi.repository import GLib, Gtk\nfrom rafcon.gui.utils.dialog import RAFCONMessageDialog\n"
        self.check_import("from helper import RAFCONMessageDialog", helper)

    def test_other_modules_and_packages_are_found_as_ever(self):
        (self.folder / "helper.py").write_text("import os\nvalue = os.sep\n")
        text = f"""
        import sys
        sys.path.insert(0, {str(self.folder)!r})
        def execute(self, inputs, outputs, gvm):
            import helper, importlib.metadata, inspect
            print(helper.value, inspect.getsource(helper).splitlines()[0], type(helper.__builtins__) is dict)
            print(len(list(importlib.metadata.distributions())))
            return 0
        """
        result = run(save(self.folder / "m", sequence(script(textwrap.dedent(text)))))
        known = len(list(importlib.metadata.distributions()))
        self.assertEqual(result.logged("stdout"), ["/ import os True", str(known)], result.logged())

    def test_a_stop_ends_it(self):
        runner = Runner(save(self.folder / "m", sequence(script(OLD))))
        runner.question()
        runner.command("stop")
        self.assertEqual(runner.finish().outcome, "preempted")

    def test_the_desktop_may_be_left_missing(self):
        result = run(save(self.folder / "m", sequence(script(OLD))), env={"RAFCON_DIALOGS": "missing"})
        self.assertEqual(result.outcome, "aborted")
        self.assertEqual(result.finished["outputs"]["error"]["__exc__"], "ModuleNotFoundError")


@unittest.skipIf(REFERENCE is None, "RAFCON_REFERENCE_PYTHON is not set")
class DialogsOfTheReference(unittest.TestCase):
    """The dialog libraries that the reference ships, unmodified."""

    def check(self, name, inputs, answers, outcome, **outputs):
        question = "import sysconfig; print(sysconfig.get_path('purelib'))"
        site = subprocess.run([REFERENCE, "-c", question], capture_output=True, text=True, check=True).stdout.strip()
        libraries = pathlib.Path(site, "rafcon", "share", "rafcon", "libraries")
        machine = libraries / "generic" / "dialog" / name
        runner = Runner(machine, inputs=list(inputs.items()), libraries=[["generic", str(libraries / "generic")]])
        for answer in answers:
            runner.answer(**answer)
        result = runner.finish()
        self.assertEqual(result.outcome, outcome, result.logged())
        found = result.finished["outputs"]
        self.assertEqual({key: found.get(key) for key in outputs}, outputs)

    def test_buttons(self):
        ask = {"message_text": "Go?", "buttons": ["yes", "no"], "abort_on_quit": True}
        with self.subTest("two"):
            self.check("2ButtonDialog", ask, [{"button": 1}], "button_2")
        with self.subTest("three"):
            self.check("3ButtonDialog", {**ask, "buttons": ["a", "b", "c"]}, [{"button": 2}], "button_3")
        with self.subTest("any"):
            self.check("GenericButtonDialog", ask, [{"button": 1}], "reponded", response_id=2)
        with self.subTest("message"):
            self.check("MessageDialog", {"message_text": "So.", "abort_on_quit": True}, [{"button": 0}], "success")

    def test_texts_and_boxes(self):
        ask = {"message_text": "Name?", "buttons": ["ok", "no"], "abort_on_quit": True}
        with self.subTest("text"):
            answers = [{"button": 0, "text": "Ada"}, {"button": 0, "checked": [True]}]
            found = {"entered_text": "Ada", "checkbox_state": True}
            self.check("InputDialog", {**ask, "checkbox_text": "sure"}, answers, "button_1", **found)
        with self.subTest("boxes"):
            answers = [{"button": 0, "checked": [False, True]}]
            found = {"checkbox_states": [False, True]}
            self.check("ColumnCheckboxDialog", {**ask, "checkbox_texts": ["a", "b"]}, answers, "button_1", **found)

    def test_newer_ones(self):
        ask = {"text": "Go?", "subtext": "Really?"}
        with self.subTest("any"):
            self.check("Show dialog", {**ask, "options": ["a", "b"]}, [{"button": 1}], "done", option=1)
        with self.subTest("two"):
            self.check("Dialog [2 options]", {**ask, "option 1": "a", "option 2": "b"}, [{"button": 1}], "option 2")
        with self.subTest("info"):
            self.check("Dialog [Info]", {**ask, "button label": "fine"}, [{"button": 0}], "done")


if __name__ == "__main__":
    unittest.main()
