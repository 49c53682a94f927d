"""The client that docs/api.md prints does what the document says, as it is printed there."""

import runpy
import subprocess
import sys
import time
import unittest
from unittest import mock

from api_server import ApiServer, REPOSITORY


def blocks():
    """The Python programs in the document."""
    text = (REPOSITORY / "docs/api.md").read_text()
    return [part.partition("\n```")[0] + "\n" for part in text.split("```python\n")[1:]]


class TheClientInTheDocument(unittest.TestCase):
    def setUp(self):
        self.server = ApiServer()
        self.addCleanup(lambda: self.server.end())
        client, program = blocks()
        for name, text in [("rafcon_client.py", client), ("step.py", program)]:
            (self.server.folder / name).write_text(text)

    def stepping(self):
        command = [sys.executable, "step.py", self.server.link]
        program = subprocess.Popen(command, cwd=self.server.folder, stdout=subprocess.PIPE, text=True)
        self.addCleanup(program.stdout.close)
        self.addCleanup(program.kill)
        return program

    def check(self, told):
        """What was told is what the run's journal has, from its beginning to its end."""
        [run] = self.server.request("GET", "/runs")
        self.assertEqual(run["phase"], "finished")
        kept = [
            f"{event['sequence']} {event['type']} {event['path']}\n"
            for event in map(flat, self.server.history(run["id"]))
            if event["type"] in ("entered", "left")
        ]
        self.assertEqual(told, kept)
        self.assertGreater(len(told), 20)

    def test_has_about_fifty_lines(self):
        lines = [line for line in blocks()[0].splitlines() if line]
        self.assertLessEqual(len(lines), 50)

    def test_steps_a_run_to_its_end(self):
        program = self.stepping()
        told = list(program.stdout)
        self.assertEqual(program.wait(), 0)
        self.check(told)

    def test_its_commands_do_not_go_by_its_own_clock(self):
        client = runpy.run_path(str(self.server.folder / "rafcon_client.py"))["Rafcon"](self.server.link)
        run = client.start("examples", "hierarchy_and_data", hold=True)
        events = client.follow(run)
        self.addCleanup(events.close)
        for ahead_s in (3600, -60):
            next(entry for entry in events if entry["event"]["type"] == "held")
            wrong_s = time.time() + ahead_s
            with self.subTest(ahead_s=ahead_s), mock.patch("time.time", return_value=wrong_s):
                self.assertEqual(client.command(run, "step_into")["answer"], "applied")

    def test_goes_on_after_the_server_was_killed(self):
        program = self.stepping()
        told = [program.stdout.readline() for _ in range(7)]
        self.server.kill()
        self.server.again()
        told += list(program.stdout)
        self.assertEqual(program.wait(), 0)
        self.check(told)


def flat(entry):
    """An event with its number, however deep it stands in a line."""
    return {**entry, **entry.get("event", {})}


if __name__ == "__main__":
    unittest.main()
