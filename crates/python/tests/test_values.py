"""Values: from files, for ports, and for people to look at."""

import enum
import json
import unittest

import stage  # noqa: F401, it comes before `rafcon`
from rafcon import _conditions
from rafcon._runtime import convert, decode, decode_plain, encode, format_error, resolve_type

try:
    import numpy
except ImportError:
    numpy = None


class Decode(unittest.TestCase):
    def check(self, text, value):
        found = decode(text)
        self.assertEqual(found, value)
        self.assertIs(type(found), type(value))

    def test_plain(self):
        for value in (None, True, 3, 0.5, "text", [1, [2]], {"a": {"b": 1}}):
            self.check(json.dumps(value), value)

    def test_special(self):
        self.check('{"__jsonqualname__": "__builtin__.tuple", "items": [1, "a"]}', (1, "a"))
        self.check('{"__jsonqualname__": "__builtin__.set", "items": [1, 1]}', {1})
        self.assertIs(decode('{"__type__": "__builtin__.float"}'), float)
        self.assertIs(decode('{"__type__": "types.NoneType"}'), type(None))
        self.assertIs(decode('[{"__type__": "int"}]')[0], int)

    def test_keys_become_integers_only_if_all_are(self):
        self.check('{"1": "a", "-2": "b"}', {1: "a", -2: "b"})
        self.check('{"1": 2, "01": 5}', {"1": 2, "01": 5})
        self.check('{"1": 2, "x": 5}', {"1": 2, "x": 5})
        self.check('{"%s": 1}' % ("9" * 5000), {"9" * 5000: 1})

    def test_a_key_of_more_digits_than_are_read_stays_a_text(self):
        for key, found in (("9" * 18, int("9" * 18)), ("9" * 19, "9" * 19), ("-" + "9" * 18, -int("9" * 18)), ("-" + "9" * 19, "-" + "9" * 19)):
            self.check('{"%s": 1}' % key, {found: 1})

    def test_what_cannot_be_decoded(self):
        with self.assertRaises(ValueError):
            decode("{")
        with self.assertRaises(ImportError):
            decode('{"__jsonqualname__": "no_such_module.Thing"}')

    @unittest.skipIf(numpy is None, "numpy is not installed")
    def test_an_array(self):
        found = decode('{"__jsonqualname__": "numpy.ndarray", "items": [[1, 2], [3, 4]]}')
        self.assertEqual(found.tolist(), [[1, 2], [3, 4]])


class DecodePlain(unittest.TestCase):
    def test_plain_data_is_as_in_files(self):
        for text in ('[1, {"2": null}]', '{"__jsonqualname__": "builtins.set", "items": [1]}', '{"__type__": "NoneType"}'):
            self.assertEqual(decode_plain(text), decode(text))

    def test_what_a_client_sends_is_the_encoding_of_values(self):
        values = (2**70, -0.0, (1, (2.5,)), {1: "left", "1": "right"}, {"1": 2}, {(1, None): []})
        for value in values:
            with self.subTest(value):
                found = decode_plain(json.dumps(encode(value)))
                self.assertEqual(repr(found), repr(value))
        self.assertEqual(decode_plain('{"__set__": [1, 2]}'), {1, 2})
        self.assertEqual(repr(decode_plain(json.dumps([encode(float("nan")), {"__float__": "inf"}]))), "[nan, inf]")
        for text in ('{"__int__": "x"}', '{"__int__": 3}', '{"__dict__": [[[], 1]]}', '{"__dict__": [1]}', '{"__set__": [[]]}'):
            with self.subTest(text), self.assertRaisesRegex(ValueError, "of a client's value"):
                decode_plain(text)

    def test_nothing_is_imported_or_constructed(self):
        hostile = (
            '{"__type__": "unittest.__main__.x"}',
            '{"__type__": "builtins.open"}',
            '{"__type__": 3}',
            '{"__jsonqualname__": "numpy.ndarray", "items": [1]}',
            '{"__jsonqualname__": ["builtins.tuple"], "items": [1]}',
            '{"__jsonqualname__": "builtins.tuple"}',
            '{"__jsonqualname__": "collections.OrderedDict"}',
            '{"__jsonqualname__": null, "__type__": "builtins.int"}',
        )
        for text in hostile:
            with self.subTest(text), self.assertRaisesRegex(ValueError, "send plain JSON"):
                decode_plain(text)


class Broken:
    def __repr__(self):
        raise RuntimeError("no")


class Colour(enum.IntEnum):
    RED = 1


class Encode(unittest.TestCase):
    def check(self, value, expected):
        found = encode(value)
        self.assertEqual(found, expected)
        self.assertEqual(json.loads(json.dumps(found, allow_nan=False)), expected)

    def test_what_json_has(self):
        for value in (None, True, 3, 0.5, "text", [1, [2]], {"a": None}):
            self.check(value, value)
        self.check(Colour.RED, 1)

    def test_what_json_lacks(self):
        self.check({1: (2, "x")}, {"__dict__": [[1, {"__tuple__": [2, "x"]}]]})
        self.check({1: "left", "1": "right"}, {"__dict__": [[1, "left"], ["1", "right"]]})
        self.check(2**53, {"__int__": "9007199254740992"})
        self.check(-0.0, {"__float__": "-0.0"})
        self.check(ValueError("bad"), {"__exc__": "ValueError", "msg": "bad"})
        self.check(dict, {"__type__": "dict"})
        self.check(float("nan"), {"__repr__": "nan", "__class__": "float"})
        self.check(b"x" * 300, {"__repr__": repr(b"x" * 300)[:200], "__class__": "bytes", "__len__": 300})
        self.check(2**4000, {"__repr__": "an int of 4001 bits", "__class__": "int"})

    def test_integers_are_digits_up_to_their_bounds(self):
        for value in (2**53 - 1, 1 - 2**53):
            self.check(value, value)
        for value in (2**53, -(2**53), 2**3400 - 1, 1 - 2**3400):
            self.check(value, {"__int__": str(value)})
        self.check(2**3400, {"__repr__": "an int of 3401 bits", "__class__": "int"})
        self.check([2**3400, 1], [{"__repr__": "an int of 3401 bits", "__class__": "int"}, 1])

    def test_texts_are_cut_at_their_bounds(self):
        for count, more in ((197, {}), (198, {"__len__": 198})):
            shown = repr(b"x" * count)
            self.check(b"x" * count, {"__repr__": shown[:200], "__class__": "bytes", **more})
        self.check(ValueError("x" * 16384), {"__exc__": "ValueError", "msg": "x" * 16384})
        self.check(ValueError("x" * 16385), {"__exc__": "ValueError", "msg": "x" * 16384 + "… (16385 characters)"})

    def test_deep_values_are_shown_as_text_below_a_depth(self):
        def nested(levels):
            value = 1
            for _ in range(levels):
                value = [value]
            return value

        self.check(nested(64), nested(64))
        found = encode([nested(64), 1])
        self.assertEqual(found[1], 1)
        inner = found
        while isinstance(inner, list):
            inner = inner[0]
        self.assertEqual(inner, {"__repr__": "[1]", "__class__": "list"})

    def test_what_resists(self):
        self.assertIn("RuntimeError", encode(Broken())["__repr__"])
        self.check("\ud800", {"__repr__": "'\\ud800'", "__class__": "str"})
        endless = []
        endless.append(endless)
        json.dumps(encode(endless))


class Types(unittest.TestCase):
    def test_names(self):
        self.assertIs(resolve_type("builtins.int"), int)
        self.assertIs(resolve_type("str"), str)
        self.assertEqual(resolve_type("collections.OrderedDict").__name__, "OrderedDict")
        self.assertEqual(resolve_type("unittest.mock.Mock").__name__, "Mock")
        self.assertIs(resolve_type("NoneType"), type(None))

    def test_names_that_name_no_type(self):
        with self.assertRaises(ImportError):
            resolve_type("no_such_module.Thing")
        with self.assertRaises(AttributeError):
            resolve_type("collections.Thing")
        with self.assertRaises(TypeError):
            resolve_type("os.path")

    def check(self, text, type_name, value):
        found = convert(text, type_name)
        self.assertEqual(found, value)
        self.assertIs(type(found), type(value))

    def test_texts_of_ports(self):
        self.check("None", "builtins.str", None)
        self.check("$name", "builtins.int", "$name")
        self.check("$", "builtins.str", "$")
        self.check("5", "builtins.int", 5)
        self.check("5", "builtins.float", 5.0)
        self.check("0", "builtins.bool", False)
        self.check("[1, 2]", "builtins.list", [1, 2])
        self.check("(1,)", "builtins.tuple", (1,))
        self.check("5", "builtins.object", 5)
        self.check('say "hi"', "builtins.object", 'say "hi"')
        self.check("ff", "pathlib.PurePosixPath", __import__("pathlib").PurePosixPath("ff"))
        self.check(7, "builtins.str", 7)

    def test_texts_that_are_no_value(self):
        for text, type_name in (("x", "builtins.int"), ("yes", "builtins.bool"), ("(1,)", "builtins.list")):
            with self.assertRaises(ValueError):
                convert(text, type_name)


class Conditions(unittest.TestCase):
    def test_the_reason_why_a_condition_fails_is_cut(self):
        head = "ValueError: "
        for length in (200, 201, 5000):
            shown = _conditions.reason(ValueError("x" * (length - len(head))))
            self.assertEqual(shown, head + "x" * (min(length, 200) - len(head)))


    def test_of_many_conditions_some_are_kept_compiled_and_all_hold(self):
        texts = [f"inputs['x'] == {number}" for number in range(2000)]
        for number, text in enumerate(texts + texts):
            self.assertTrue(_conditions.check(text, {"x": number % 2000}, None, {}, None))
        self.assertEqual(_conditions._code.cache_info().currsize, 1000)


class Tracebacks(unittest.TestCase):
    def run_script(self, text):
        module = {}
        try:
            exec(compile(text, "/m/A/script.py", "exec"), module)
            module["execute"]()
        except BaseException as error:
            return format_error(error, "/m/A/script.py")

    def test_it_begins_in_the_script(self):
        shown = self.run_script("import json\ndef execute():\n    json.loads('{')\n")
        self.assertTrue(shown.startswith('Traceback (most recent call last):\n  File "/m/A/script.py", line 3'), shown)
        self.assertNotIn("test_values", shown)
        self.assertIn("json.decoder.JSONDecodeError", shown)

    def test_a_script_that_does_not_parse(self):
        shown = self.run_script("def execute(:\n")
        self.assertIn('File "/m/A/script.py", line 1', shown)
        self.assertIn("SyntaxError", shown)
        self.assertNotIn("test_values", shown)

    def test_of_many_frames_the_innermost_are_shown(self):
        for left, frames in ((19, 39), (20, 40), (150, 40)):
            text = f"def execute(left={left}):\n    if left: other(left - 1)\n    1 / 0\ndef other(left):\n    execute(left)\n"
            with self.subTest(left):
                shown = self.run_script(text)
                places = [line for line in shown.splitlines() if line.lstrip().startswith("File ")]
                self.assertEqual(len(places), frames, shown)
                self.assertTrue(places[-1].endswith("line 3, in execute"), shown)
                self.assertTrue(shown.endswith("ZeroDivisionError: division by zero"), shown)

    def test_a_script_without_execute(self):
        self.assertEqual(self.run_script("x = 1\n"), "KeyError: 'execute'")


if __name__ == "__main__":
    unittest.main()
