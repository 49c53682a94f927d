"""What a run keeps of values: a runner dies in the middle of its run, and another one resumes it."""

import importlib.util
import json
import pathlib
import pickle
import tempfile
import textwrap
import unittest

from support import run, save, script, sequence

#: Dies the first time that it runs.
ONCE = """
import os, pathlib
marker = pathlib.Path(os.environ["TEST_FOLDER"], "died")
if not marker.exists():
    marker.touch()
    os.kill(os.getpid(), 9)
"""


def execute(body, head="", **state):
    """A state with this body of ``execute``."""
    text = head + "\ndef execute(self, inputs, outputs, gvm):\n"
    return script(text + textwrap.indent(textwrap.dedent(body).strip("\n"), "    ") + "\n", **state)


class Lives(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.run_folder = self.folder / "run"
        self.run_folder.mkdir(mode=0o700)
        self.options = {"run_folder": str(self.run_folder), "env": {"TEST_FOLDER": str(self.folder)}}

    def die(self, root):
        """The first life, which ends by a signal."""
        first = run(save(self.folder / "machine", root), **self.options)
        self.assertEqual(first.exit_code, -9, first.logged())
        return first

    def resume(self, policy="restart", **resume):
        """The second life."""
        return run(self.folder / "machine", resume={"policy": policy, **resume}, **self.options)

    def live_twice(self, root):
        self.die(root)
        return self.resume()

    def live_on_with(self, *expressions, before="", head="", outcome="success"):
        """One state makes values, the next dies, runs again and compares what it gets with values made anew."""
        ports = [("v%d" % index, "object", None) for index in range(len(expressions))]
        make = "\n".join('outputs["v%d"] = %s' % pair for pair in enumerate(expressions))
        look = "\n".join(
            'show(%r, inputs["v%d"], %s)' % (expression, index, expression)
            for index, expression in enumerate(expressions)
        )
        compare = """
def show(text, found, expected):
    if type(found) is not type(expected) or repr(found) != repr(expected):
        print(text, "became", type(found).__name__, repr(found))
"""
        first = execute(before + make + "\nreturn 0", head, id="A", outputs=ports)
        second = execute(look + "\nprint('done')\nreturn 0", head + ONCE + compare, id="B", inputs=ports)
        flows = [("A", name, "B", name) for name, *_ in ports]
        result = self.live_twice(sequence(first, second, flows=flows))
        self.assertEqual(result.outcome, outcome, result.logged())
        return result


class Values(Lives):
    def test_values_of_python_come_back_as_they_were(self):
        result = self.live_on_with(
            "None",
            "True",
            "3",
            "2**64",
            "-(2**200)",
            "0.1 + 0.2",
            "float('nan')",
            "-0.0",
            "'grün'",
            "'x' * 300",
            "'\\ud800'",
            "b'\\x00\\xff'",
            "bytearray(b'ab')",
            "1 + 2j",
            "[1, [2.5, 'a'], None]",
            "(1, (2, 3))",
            "{'a': 1, 'b': [1, 2]}",
            "{'b': 1, 'a': 2}",
            "{1: 'x', (2, 3): 'y'}",
            "{'__tuple__': [1]}",
            "{1, 2}",
            "frozenset([1])",
            "range(3)",
            "[0.1] * 1000",
            "{'%d' % n: n for n in range(2000)}",
            "[[[[[[[[[[[[[[[[[[[[1]]]]]]]]]]]]]]]]]]]]",
            "int",
            "ValueError",
        )
        self.assertEqual(result.logged("stdout"), ["done"])

    def test_objects_of_modules_come_back(self):
        result = self.live_on_with(
            "datetime.datetime(2026, 1, 2)",
            "decimal.Decimal('1.10')",
            "collections.OrderedDict(a=1)",
            "pathlib.PurePosixPath('/a')",
            head="import collections, datetime, decimal, pathlib\n",
        )
        self.assertEqual(result.logged("stdout"), ["done"])

    def test_what_is_shared_stays_shared(self):
        root = sequence(
            execute("item = [1]\noutputs['v'] = [item, item]\nreturn 0", id="A", outputs=[("v", "list", None)]),
            execute("print(inputs['v'][0] is inputs['v'][1])\nreturn 0", ONCE, id="B", inputs=[("v", "list", None)]),
            flows=[("A", "v", "B", "v")],
        )
        self.assertEqual(self.live_twice(root).logged("stdout"), ["True"])

    def test_an_array_comes_back(self):
        try:
            import numpy  # noqa: F401, scripts use it
        except ImportError:
            self.skipTest("numpy is not installed for this interpreter")
        result = self.live_on_with("numpy.arange(6.0).reshape(2, 3)", "numpy.float32(1.5)", head="import numpy\n")
        self.assertEqual(result.logged("stdout"), ["done"])

    def test_a_large_value_is_kept_once_in_a_file_of_its_own(self):
        result = self.live_on_with("bytes(200000)", "bytes(200000)")
        self.assertEqual(result.logged("stdout"), ["done"])
        files = list((self.run_folder / "values").iterdir())
        self.assertEqual(len(files), 1, files)
        self.assertGreater(files[0].stat().st_size, 200000)
        self.assertEqual((self.run_folder / "values").stat().st_mode & 0o777, 0o700)

    def test_a_value_has_a_file_of_its_own_from_some_size_on(self):
        # The head and the end of a pickle of bytes.
        more = len(pickle.dumps(bytes(60_000))) - 60_000
        self.live_on_with(f"bytes({64 * 1024 - more})")
        self.assertEqual(list(self.run_folder.glob("values/*")), [])
        self.setUp()
        result = self.live_on_with(f"bytes({64 * 1024 - more + 1})")
        self.assertEqual(result.logged("stdout"), ["done"])
        self.assertEqual(len(list(self.run_folder.glob("values/*"))), 1)

    def test_the_reason_why_a_value_is_not_kept_is_cut(self):
        head = "import types\nmodule = types.ModuleType('m')\nexec('class Bad:\\n def __reduce__(self): raise ValueError(\"ä\" * 1000)', module.__dict__)\n"
        first = execute("outputs['v'] = module.Bad()\nreturn 0", head, id="A", outputs=[("v", "object", None)])
        second = execute("print('never')\nreturn 0", ONCE, id="B", inputs=[("v", "object", None)])
        result = self.live_twice(sequence(first, second, flows=[("A", "v", "B", "v")]))
        self.check_lost(result, "ValueError: ")
        error = result.finished["outputs"]["error"]["msg"]
        self.assertEqual(error.count("ä"), 300 - len("ValueError: "), error)

    def test_a_damaged_file_is_an_error_that_names_the_value(self):
        root = sequence(
            execute("outputs['v'] = bytes(200000)\nreturn 0", id="A", outputs=[("v", "object", None)]),
            execute("print('never')\nreturn 0", ONCE, id="B", inputs=[("v", "object", None)]),
            flows=[("A", "v", "B", "v")],
        )
        self.die(root)
        (file,) = (self.run_folder / "values").iterdir()
        file.write_bytes(b"x" * 200000)
        self.check_lost(self.resume(), '"v"', "is damaged")

    def check_lost(self, result, *words):
        self.assertEqual(result.outcome, "aborted")
        self.assertNotIn("never", result.logged("stdout"))
        error = result.finished["outputs"]["error"]["msg"]
        for word in words:
            self.assertIn(word, error)

    def check_placeholder(self, value, *words, head=""):
        """A run with such a value goes on; if it is needed after a crash, the state that needs it aborts."""
        first = execute("outputs['v'] = %s\nreturn 0" % value, head, id="A", outputs=[("v", "object", None)])
        second = execute("print('never')\nreturn 0", ONCE, id="B", inputs=[("v", "object", None)])
        root = sequence(first, second, flows=[("A", "v", "B", "v")])
        self.check_lost(self.live_twice(root), '"v"', *words)

    def test_a_lock_leaves_a_placeholder(self):
        self.check_placeholder("threading.Lock()", "lock", head="import threading\n")

    def test_an_object_of_a_class_of_the_script_leaves_a_placeholder(self):
        self.check_placeholder("Own()", "put the class into a module", head="class Own: pass\n")

    def test_a_pickle_that_fails_in_any_way_leaves_a_placeholder(self):
        head = "import types\nclass Bad:\n    def __reduce__(self):\n        raise SystemExit('no')\n"
        self.check_placeholder("[Bad()]", "SystemExit", head=head)

    def test_an_object_that_cannot_be_shown_is_no_problem(self):
        head = "class Bad:\n    def __repr__(self):\n        raise ValueError\n"
        self.check_placeholder("Bad()", "v", head=head)

    def test_a_state_may_keep_its_values_to_itself(self):
        ports = [("v", "list", None), ("n", "int", 0)]
        first = execute("outputs['v'] = [1]\noutputs['n'] = 5\nreturn 0", id="A", outputs=ports)
        first["semantic_data"] = {"journal": "status"}
        second = execute("print('never')\nreturn 0", ONCE, id="B", inputs=ports)
        flows = [("A", "v", "B", "v"), ("A", "n", "B", "n")]
        self.check_lost(self.live_twice(sequence(first, second, flows=flows)), '"v"', "keeps no values")

    def test_an_exception_comes_back_or_is_stood_in_for(self):
        head = "class Own(Exception): pass\n"
        for raised, shown in (("KeyError('k')", "KeyError('k')"), ("Own('o')", "RuntimeError('Own: o')")):
            with self.subTest(raised):
                self.setUp()
                handler = execute("print(repr(inputs['error']))\nreturn 0", ONCE, id="B")
                root = sequence(execute("raise " + raised, head, id="A"), handler)
                root["transitions"].append(("A", -1, "B"))
                self.assertEqual(self.live_twice(root).logged("stdout"), [shown])


class Variables(Lives):
    def test_global_variables_are_as_they_were(self):
        make = """
            gvm.set_variable("a", [1])
            gvm.set_variable("a", [2])
            gvm.set_variable("typed", 3, data_type=int)
            shared = {"n": 1}
            gvm.set_variable("shared", shared, per_reference=True)
            gvm.set_variable("gone", 1)
            gvm.delete_variable("gone")
            return 0
            """
        look = """
            print(gvm.get_variable("a"), gvm.get_variable("typed"), gvm.get_data_type("typed").__name__)
            gvm.get_variable("shared", per_reference=True)["n"] += 1
            print(gvm.get_variable("shared"), gvm.variable_exist("gone"), inputs["x"])
            return 0
            """
        root = sequence(
            execute(make, id="A"), execute(look, ONCE, id="B", inputs=[("x", "list", "$a")])
        )
        self.assertEqual(self.live_twice(root).logged("stdout"), ["[2] 3 int", "{'n': 2} False [2]"])

    def test_a_global_variable_that_cannot_be_kept_is_missing_afterwards(self):
        root = sequence(
            execute("import threading\ngvm.set_variable('l', threading.Lock(), per_reference=True)\nreturn 0", id="A"),
            execute("print(gvm.variable_exist('l'))\nreturn 0", ONCE, id="B"),
        )
        result = self.live_twice(root)
        self.assertEqual(result.logged("stdout"), ["False"])
        self.assertTrue(any('"l"' in line for line in result.logged("engine")), result.logged("engine"))

    def test_persistent_variables_are_as_they_were(self):
        count = """
            known = self.persistent_variables
            known["count"] = known.get("count", 0) + 1
            print(known["count"])
            return 0
            """
        again = sequence(
            execute(count, id="A"),
            execute("return 1 if gvm.get_variable('second') else 0", "", id="B", outcomes=("again", "end")),
            execute("gvm.set_variable('second', True)\nreturn 0", ONCE, id="C"),
        )
        again["transitions"] = [(None, None, "A"), ("A", 0, "B"), ("B", 0, "C"), ("C", 0, "A"), ("B", 1, 0)]
        self.assertEqual(self.live_twice(again).logged("stdout"), ["2"])


class Views(unittest.TestCase):
    def check(self, value, *views, head=""):
        shown = self.shown(value, head)
        for view in views:
            self.assertEqual(view, {key: shown[key] for key in view} if isinstance(view, dict) else shown)

    def shown(self, value, head=""):
        """What people see of a value: a script looks back at another's outputs, which are on disk by then."""
        make = execute("outputs['v'] = %s\nreturn 0" % value, head, id="A", outputs=[("v", "object", None)])
        look = """
            import json
            (left,) = [item for item in self.execution_history if item.path == "R/A" and item.outcome]
            print(json.dumps(left.input_output_data["v"]))
            return 0
            """
        with tempfile.TemporaryDirectory() as folder:
            root = sequence(make, execute(look, id="B"))
            result = run(save(pathlib.Path(folder) / "machine", root), strict=True)
        (line,) = result.logged("stdout") or [None]
        self.assertLess(len(line), 20_000)
        return json.loads(line)

    def test_plain_values(self):
        self.check("{'a': [1, (2, None)], 'b': 0.5}", {"a": [1, {"__tuple__": [2, None]}], "b": 0.5})
        self.check("{1: 2, (3,): 4}", {"__dict__": [[1, 2], [{"__tuple__": [3]}, 4]]})
        self.check("2**64", {"__int__": "18446744073709551616"})
        self.check("[2**53 - 1, 2**53, -0.0]", [2**53 - 1, {"__int__": str(2**53)}, {"__float__": "-0.0"}])
        self.check("[float('inf')]", [{"__repr__": "inf", "__class__": "float"}])

    def test_large_ones_are_cut(self):
        first = [0] * 255
        self.check("[0] * 1000", {"__class__": "list", "__len__": 1000, "__repr__": "list of 1000", "__first__": first})
        self.check("{'%03d' % n: n for n in range(300)}", {"__class__": "dict", "__len__": 300})
        self.check("'x' * 5000", {"__repr__": "x" * 200, "__class__": "str", "__len__": 5000})
        self.check("bytes(10**6)", {"__class__": "bytes"})
        self.check("set(range(10**5))", {"__repr__": "set of many", "__class__": "set", "__len__": 10**5})
        self.check("[[[0] * 200, [0] * 200]] * 5")

    def test_containers_are_cut_at_their_bounds(self):
        most, cut = [0] * 255, [0] * 256
        self.check("[0] * 255", most)
        self.check("[0] * 256", {"__class__": "list", "__len__": 256, "__repr__": "list of 256", "__first__": most})
        for levels, innermost in ((16, []), (17, {"__repr__": "a nested list", "__class__": "list"})):
            shown = self.shown("[" * levels + "]" * levels)
            for _ in range(levels - 1):
                (shown,) = shown
            self.assertEqual(shown, innermost)

    def test_texts_and_numbers_are_cut_at_their_bounds(self):
        head = "class Loud:\n    def __init__(self, count): self.count = count\n    def __repr__(self): return 'x' * self.count\n"
        cases = (
            ("'x' * 1024", "x" * 1024),
            ("'x' * 1025", {"__repr__": "x" * 200, "__class__": "str", "__len__": 1025}),
            ("Loud(200)", {"__repr__": "x" * 200, "__class__": "Loud"}),
            ("Loud(201)", {"__repr__": "x" * 200, "__class__": "Loud", "__len__": 201}),
            ("2**3400 - 1", {"__int__": str(2**3400 - 1)}),
            ("2**3400", {"__repr__": "an int of 3401 bits", "__class__": "int"}),
            ("1", 1),
        )
        self.check(f"[{', '.join(value for value, _view in cases)}]", [view for _value, view in cases], head=head)
        self.check("ValueError('x' * 16384)", {"__exc__": "ValueError", "msg": "x" * 16384})
        self.check("ValueError('x' * 16385)", {"__exc__": "ValueError", "msg": "x" * 16384 + "… (16385 characters)"})

    def test_others_show_what_they_say_of_themselves(self):
        self.check("ValueError('no')", {"__exc__": "ValueError", "msg": "no"})
        self.check("int", {"__type__": "int"})
        bad = "class Bad:\n    def __repr__(self):\n        raise ValueError\n"
        self.check("Bad()", {"__repr__": "<Bad that cannot be shown>", "__class__": "Bad"}, head=bad)
        array = "class Array:\n    shape, dtype = (2, 3), 'float32'\n"
        self.check("Array()", {"__class__": "Array", "__shape__": [2, 3], "__dtype__": "float32"}, head=array)


#: What arrays of libraries have in common, so that tests need none of these.
ARRAY = """
class Type:
    def __init__(self, kind):
        self.kind = kind

    def __str__(self):
        return {"f": "float64", "b": "bool", "i": "int64", "O": "object"}[self.kind]


class Array:
    def __init__(self, shape, at, kind="f", axes=None):
        self.shape, self.at, self.dtype = shape, at, Type(kind)
        self.axes = [range(count) for count in shape] if axes is None else axes

    def __getitem__(self, slices):
        axes = [axis[each] for axis, each in zip(self.axes, slices)]
        return Array(tuple(map(len, axes)), self.at, self.dtype.kind, axes)

    def tolist(self, where=()):
        if len(where) == len(self.axes):
            return self.at(*where)
        assert len(self.axes[len(where)]) <= 256, "all of it would be copied"
        return [self.tolist(where + (index,)) for index in self.axes[len(where)]]

    def __reduce__(self):
        raise TypeError("it is not kept")
"""


class Arrays(unittest.TestCase):
    check, shown = Views.check, Views.shown

    def test_small_ones_are_kept_whole(self):
        whole = {"__shape__": [2, 3], "__dtype__": "float64", "__items__": [0.0, 0.5, 1.0, 1.0, 1.5, 2.0]}
        sampled = {"__sampled__": [2, 3], "__steps__": [1, 1]}
        self.check("Array((2, 3), lambda row, column: row + column / 2)", dict(whole, **sampled), head=ARRAY)
        self.check("Array((), lambda: 7, 'i')", {"__shape__": [], "__items__": [7], "__sampled__": []}, head=ARRAY)
        self.check("Array((2,), lambda at: at == 1, 'b')", {"__items__": [False, True]}, head=ARRAY)
        self.check("Array((16, 16), lambda *at: 1.0)", {"__items__": [1.0] * 256}, head=ARRAY)
        self.check("Array((0,), lambda at: 1.0)", {"__shape__": [0], "__items__": []}, head=ARRAY)

    def test_of_large_ones_some_numbers_are_kept_evenly_spaced(self):
        sampled = {"__shape__": [1000, 10**12], "__sampled__": [16, 16], "__steps__": [63, 62500000000]}
        items = {"__items__": [float(row) for row in range(0, 1000, 63) for _ in range(16)]}
        self.check("Array((1000, 10**12), lambda row, column: float(row))", dict(sampled, **items), head=ARRAY)

    def test_short_axes_are_kept_whole_and_long_ones_share_what_is_left(self):
        for shape, sampled, steps in (
            ("(257,)", [129], [2]),
            ("(480, 640, 3)", [9, 9, 3], [54, 72, 1]),
            ("(3, 10**6)", [3, 85], [1, 11765]),
            ("(5, 0, 7)", [5, 0, 7], [1, 1, 1]),
            ("(2,) * 12", [1] * 12, [2] * 12),
        ):
            view = {"__sampled__": sampled, "__steps__": steps}
            self.check(f"Array({shape}, lambda *at: 1.0)", view, head=ARRAY)

    def test_numbers_that_json_does_not_have(self):
        special = [{"__repr__": text, "__class__": "float"} for text in ("nan", "inf", "-inf")]
        values = "(float('nan'), float('inf'), float('-inf'))"
        self.check(f"Array((3,), lambda at: {values}[at])", {"__items__": special}, head=ARRAY)

    def test_inside_of_other_values_they_leave_room(self):
        head = ARRAY + "\nbig = Array((1000,), float)\n"
        view = {"__shape__": [1000], "__dtype__": "float64", "__sampled__": [63], "__steps__": [16]}
        shown = self.shown("{'big': big, 'pose': {'x': 1, 'y': [2, 3]}}", head)
        self.assertEqual(view, {key: shown["big"][key] for key in view})
        self.assertEqual({"x": 1, "y": [2, 3]}, shown["pose"])
        for count, sampled in ((64, 64), (65, 33)):
            shown = self.shown(f"[Array(({count},), float)]", ARRAY)
            self.assertEqual(([count], [sampled]), (shown[0]["__shape__"], shown[0]["__sampled__"]))

    def test_objects_in_arrays_and_arrays_that_refuse(self):
        for value in ("Array((2,), lambda at: 'text', 'O')", "Array((2,), lambda at: 'text')", "Array((2,), None)"):
            shown = self.shown(value, ARRAY)
            self.assertNotIn("__items__", shown)
            self.assertEqual([2], shown["__shape__"])

    @unittest.skipUnless(importlib.util.find_spec("numpy"), "numpy is not there")
    def test_arrays_of_numpy(self):
        head = "import numpy"
        self.check("numpy.arange(6.0).reshape(2, 3)", {"__items__": [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]}, head=head)
        self.check("numpy.zeros((1000, 1000, 3), 'uint8')", {"__sampled__": [9, 9, 3], "__items__": [0] * 243}, head=head)
        self.check("numpy.float32(0.5)", {"__shape__": [], "__items__": [0.5]}, head=head)
        self.check("numpy.array([True, False])", {"__dtype__": "bool", "__items__": [True, False]}, head=head)
        self.assertNotIn("__items__", self.shown("numpy.array([1j])", head))
        self.assertNotIn("__items__", self.shown("numpy.zeros(2, 'i4,f8')", head))


class Journal(unittest.TestCase):
    def test_without_a_journal_nothing_is_pickled(self):
        head = "class Bad:\n    def __reduce__(self):\n        print('pickled')\n        return (Bad, ())\n"
        with tempfile.TemporaryDirectory() as folder:
            body = "outputs['v'] = Bad()\ngvm.set_variable('v', 1)\nreturn 0"
            state = execute(body, head, outputs=[("v", "object", None)])
            result = run(save(pathlib.Path(folder) / "machine", sequence(state)), keeping="off")
        self.assertEqual((result.outcome, result.logged("stdout")), ("success", []))


if __name__ == "__main__":
    unittest.main()
