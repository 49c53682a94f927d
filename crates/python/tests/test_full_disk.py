"""A disk that refuses: the run is paused, nothing is lost, and it goes on by itself once there is room."""

import pathlib
import tempfile
import unittest

import support

FULL = """
import resource

def execute(self, inputs, outputs, gvm):
    limit, highest = resource.getrlimit(resource.RLIMIT_FSIZE)
    # No file of this process grows any more; memory that is a file stays as it is.
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, highest))
    self.logger.info("there is no room")
    self.wait_for_interruption()
    self.logger.info("paused: %s" % self.paused)
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, highest))
    return 0
"""
AFTER = "def execute(self, inputs, outputs, gvm):\n    return 0\n"


class FullDisk(unittest.TestCase):
    def test_the_run_pauses_and_goes_on_when_there_is_room(self):
        with tempfile.TemporaryDirectory() as folder:
            states = [support.script(FULL, id="FULL"), support.script(AFTER, id="AFTER")]
            machine = support.save(pathlib.Path(folder) / "machine", support.sequence(*states))
            result = support.run(machine)
        self.assertEqual(result.outcome, "success")
        told = [line for line in result.logged() if line.startswith(("there", "paused", "the journal"))]
        kinds = [line.split(":")[0] for line in told]
        self.assertEqual(sorted(kinds), ["paused", "the journal cannot be written", "the journal is written again", "there is no room"])
        self.assertIn("paused: True", told)
        problems = [m["journal_problem"] for m in result.messages if m["message"] == "snapshot"]
        self.assertTrue(any(problems), "a snapshot says that the journal cannot be written")
        numbers = [m["sequence"] for m in result.messages if m["message"] == "event"]
        self.assertEqual(numbers, list(range(1, len(numbers) + 1)), "no event is lost")


if __name__ == "__main__":
    unittest.main()
