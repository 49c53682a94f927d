"""Any Python value: what a run tells of it reads back as the same value, or says that it is not all of it."""

import json
import os
import pathlib
import tempfile
import unittest

import value_source
from support import run, save, script, sequence

HERE = pathlib.Path(__file__).parent
#: Pairs of what a run tells and what it was, for the tests of the page.
RECORDED = HERE.parents[2] / "web" / "src" / "model" / "testing" / "recorded_values.json"
RECORDED_COUNT = 400
#: How many values are tried, where a few are not enough, and how many in one run.
COUNT = int(os.environ.get("RAFCON_TEST_VALUES", RECORDED_COUNT))
#: So few that the last event of a run has all of them whole.
BATCH = 50

#: A state makes values as outputs and global variables; the next one writes down what the run keeps of the outputs for people.
MAKE = """
import sys
sys.path.insert(0, %r)
import value_source
def execute(self, inputs, outputs, gvm):
    for number in range(%d, %d):
        outputs["v%%d" %% number] = value_source.value(number)
        gvm.set_variable("v%%d" %% number, value_source.value(number))
    return 0
"""
LOOK = """
import json
def execute(self, inputs, outputs, gvm):
    (left,) = [item for item in self.execution_history if item.path == "R/A" and item.outcome]
    with open(%r, "w") as file:
        json.dump(left.input_output_data, file)
    return 0
"""


def told(first, last):
    """What a run tells of the values with these numbers: in its journal, and in its results."""
    names = ["v%d" % number for number in range(first, last)]
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder, "views")
        make = script(MAKE % (str(HERE), first, last), outputs=[(name, "object", None) for name in names])
        root = sequence(make, script(LOOK % str(file), id="B"))
        result = run(save(pathlib.Path(folder, "machine"), root))
        views = json.loads(file.read_text())
    globals_ = result.finished["globals"]
    return [views[name] for name in names], [globals_[name] for name in names if name in globals_]


def is_literal(value):
    """Whether a person can type the value into the page."""
    if isinstance(value, (list, tuple)):
        return all(map(is_literal, value))
    if isinstance(value, dict):
        return all(map(is_literal, value)) and all(map(is_literal, value.values()))
    is_number = type(value) in (bool, int, float, type(None))
    return is_number or (isinstance(value, str) and "\ud800" not in value)


class Identity(unittest.TestCase):
    def check(self, which):
        wrong = []
        for first in range(0, COUNT, BATCH):
            numbers = range(first, min(first + BATCH, COUNT))
            shown = told(numbers.start, numbers.stop)[which]
            self.assertEqual(len(shown), len(numbers))
            wrong += [number for number, one in zip(numbers, shown) if value_source.fails(one, value_source.value(number))]
        if "RAFCON_TEST_VALUES" in os.environ:
            print(json.dumps({"name": "value_identity_failures", "value": len(wrong), "of": COUNT, "bar": 0}), flush=True)
        self.assertEqual([(number, value_source.value(number)) for number in wrong[:3]], [])

    def test_views_read_back_as_the_same_values(self):
        self.check(0)

    def test_results_read_back_as_the_same_values(self):
        self.check(1)

    def test_texts_up_to_the_bound_of_an_event_and_beyond_stay_the_same(self):
        texts = ["x" * length for length in range(60, 70)] + ["x" * length + "é" for length in range(60, 66)]
        make = "def execute(self, inputs, outputs, gvm):\n    for number, text in enumerate(%r):\n        outputs[str(number)] = text\n    return 0\n"
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "views")
            ports = [(str(number), "str", None) for number in range(len(texts))]
            root = sequence(script(make % texts, outputs=ports), script(LOOK % str(file), id="B"))
            run(save(pathlib.Path(folder, "machine"), root))
            views = json.loads(file.read_text())
        self.assertEqual([views[str(number)] for number in range(len(texts))], texts)

    def test_a_value_that_is_shown_as_another_is_noticed(self):
        self.assertTrue(value_source.fails({"1": "right"}, {1: "left", "1": "right"}))
        self.assertTrue(value_source.fails(0.0, -0.0))
        self.assertTrue(value_source.fails(1, True))

    def test_the_recorded_values_are_those_of_this_version(self):
        views = told(0, RECORDED_COUNT)[0]
        literals = [number for number in range(RECORDED_COUNT) if is_literal(value_source.value(number))]
        recorded = [views[number] for number in literals]
        if "RAFCON_RECORD_VALUES" in os.environ:
            RECORDED.write_text("[\n  " + ",\n  ".join(json.dumps(view) for view in recorded) + "\n]\n")
        self.assertEqual(json.loads(RECORDED.read_text()), recorded)


if __name__ == "__main__":
    unittest.main()
