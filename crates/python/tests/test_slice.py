"""From the socket to a script and back."""

import tempfile
import unittest

from support import Runner, container, run, save, script, sequence


class Slice(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def save(self, root):
        return save(self.folder.name, root)

    def test_states_run_in_order_with_data(self):
        count = "def execute(self, inputs, outputs, gvm):\n    outputs['i'] = inputs['i'] + 1\n    return 'success'\n"
        ports = {"inputs": [("i", "int", 0)], "outputs": [("i", "int", 0)]}
        machine = sequence(
            script(count, "A", **ports),
            script(count, "B", **ports),
            outputs=[("i", "int", 0)],
            flows=[("A", "i", "B", "i"), ("B", "i", None, "i")],
        )
        result = run(self.save(machine))
        self.assertEqual(result.steps(), ["+R", "+R/A", "-R/A=success", "+R/B", "-R/B=success", "-R=success"])
        self.assertEqual(result.finished["outputs"], {"i": 2})
        self.assertEqual(result.finished["states_run"], 3)
        self.assertEqual(result.exit_code, 0)

    def test_print_and_log_carry_their_state(self):
        text = "def execute(self, inputs, outputs, gvm):\n    print('hello')\n    self.logger.info('from %s', self.name)\n    return 0\n"
        result = run(self.save(sequence(script(text))))
        self.assertEqual(result.logged("stdout", "R/A"), ["hello"])
        self.assertEqual(result.logged("logger", "R/A"), ["from a"])

    def test_another_version_is_refused(self):
        machine = self.save(sequence(script("def execute(*a): return 0")))
        result = Runner(machine, hello={"protocol": 999, "program": "9"}).finish()
        self.assertEqual(result.exit_code, 1)
        self.assertIn("install the rafcon binary and its extension from the same build", result.printed["stderr"])


if __name__ == "__main__":
    unittest.main()
