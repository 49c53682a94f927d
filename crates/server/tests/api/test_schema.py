"""The interface does what its OpenAPI document says: no server error, no answer that is not described, whatever is asked."""

import json
import pathlib
import subprocess
import sys
import time
import unittest

from api_server import ApiServer

# A route is asked so often with made-up parameters, and so often with those of things that are there.
EXAMPLES = 8

CHECKS = [
    "not_a_server_error",
    "status_code_conformance",
    "content_type_conformance",
    "response_headers_conformance",
    "response_schema_conformance",
    "unsupported_method",
]

# Would end what the other requests ask about.
DESTRUCTIVE = [
    "DELETE /api/v1/runs/{run}",
    "POST /api/v1/runs/prune",
    "POST /api/v1/machines/{machine}/close",
]

TOOL = pathlib.Path(sys.executable).with_name("st")


class TheDescription(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server = ApiServer()
        cls.addClassCleanup(cls.server.end)

    def started(self, number, **more):
        machine = {"project": "examples", "path": "hierarchy_and_data"}
        body = {"id": f"schema-{number}", "machine": machine, **more}
        return self.server.request("POST", "/runs", body)["id"]

    def finished(self, number):
        run = self.started(number)
        while self.server.request("GET", f"/runs/{run}")["run"]["phase"] != "finished":
            time.sleep(0.05)
        return run

    def check(self, *options, parameters=""):
        config = self.server.folder / "schemathesis.toml"
        config.write_text(parameters)
        command = [TOOL, f"--config-file={config}", "run", f"{self.server.url}/api/v1/openapi.json"]
        command += ["--header", f"Authorization: Bearer {self.server.token}"]
        command += ["--checks", ",".join(CHECKS), "--phases=examples,coverage,fuzzing"]
        command += [f"--max-examples={EXAMPLES}", "--seed=1", "--continue-on-failure", "--no-color"]
        ended = subprocess.run(
            command + list(options), cwd=self.server.folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )
        self.assertEqual(ended.returncode, 0, ended.stdout)

    def test_holds_for_made_up_parameters(self):
        self.check()

    def test_holds_for_what_is_there(self):
        first, second = self.finished(1), self.finished(2)
        held = self.started(3, hold=True)
        where = {"project": "examples", "path": "mission"}
        machine = self.server.request("POST", "/machines/open", {"file": where})["id"]
        things = {"other": second, "machine": machine, "project": "examples", "root": "library"}
        things |= {"path": library(self.server), "value": 1, "sequence": 5}
        without = [f"--exclude-name={name}" for name in DESTRUCTIVE]
        self.check(*without, parameters=given({**things, "run": first}))
        runs = "--include-path-regex=/runs/"
        self.check(runs, *without, parameters=given({**things, "run": held}))


def given(things):
    """Parameters of routes that are not made up."""
    lines = [f'"path.{name}" = {json.dumps(value)}' for name, value in things.items()]
    return "\n".join(["[parameters]", *lines, ""])


def library(server):
    """The path of a library below its root."""
    [node] = server.request("GET", "/libraries")
    path = []
    while node.get("kind") != "library":
        node = node["children"][0]
        path.append(node["name"])
    return "/".join(path)


if __name__ == "__main__":
    unittest.main()
