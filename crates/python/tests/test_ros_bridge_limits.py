"""The bounds of the bridge to ROS, in front of a server that answers from a table."""

import http.server
import json
import threading
import types
import unittest
import urllib.parse

import stage  # noqa: F401, it brings the package
from rafcon.ros import GoalAborted
from rafcon.ros.bridge import _goals, _machines
from rafcon.ros.bridge._client import Client, Refused
from rafcon.ros.bridge._goals import Asked, Goals
from rafcon.ros.bridge._machines import Machine
from rafcon.ros.bridge._watch import Watch


class Server(http.server.ThreadingHTTPServer):
    """Has runs and folders; starts whatever run it is asked for."""

    daemon_threads = True

    def __init__(self):
        http.server.ThreadingHTTPServer.__init__(self, ("127.0.0.1", 0), Answers)
        self.runs = []
        #: How deep its one machine lies.
        self.levels = 0
        #: What its runs end with.
        self.outputs = {}

    def answer(self, path, query):
        if path == "/runs":
            self.runs.append(run(f"started{len(self.runs)}", "live"))
            return self.runs[-1]
        if path == "/status":
            return {"runs": self.runs, "files_revision": 1}
        if path == "/projects":
            return [{"id": "p", "folder": "/p"}]
        if path == "/projects/p/tree":
            return self.folder(query.get("path", [""])[0])
        if path.endswith("/results"):
            return {"outputs": self.outputs, "globals": {}, "scoped_variables": {}}
        found = [each for each in self.runs if path == "/runs/" + each["id"]]
        return {"run": found[0], "snapshot": {}, "control": {}, "now_ms": 0} if found else None

    def folder(self, path):
        """A folder with the one in it, whose content has to be asked for."""
        inner = f"{path}/f".lstrip("/")
        if path.count("f") == self.levels:
            return {"kind": "folder", "path": path, "children": [{"kind": "machine", "path": f"{path}/m"}]}
        return {"kind": "folder", "path": path, "children": [{"kind": "folder", "path": inner, "is_cut": True}]}


class Answers(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    wbufsize = -1

    def answer(self):
        self.rfile.read(int(self.headers.get("Content-Length", 0)))
        asked = urllib.parse.urlsplit(self.path)
        found = self.server.answer(asked.path[len("/api/v1") :], urllib.parse.parse_qs(asked.query))
        body = json.dumps(found).encode()
        self.send_response(404 if found is None else 200)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    do_GET = do_POST = answer  # noqa: N815, the names are those of the base class

    def log_message(self, *_arguments):
        pass


def run(name, phase, **more):
    return {"id": name, "name": name, "phase": phase, "events": 1, "outcome": {"name": "success"}, **more}


class Bounds(unittest.TestCase):
    def setUp(self):
        self.server = Server()
        thread = threading.Thread(target=self.server.serve_forever, args=(0.01,))
        thread.start()
        self.client = Client(f"http://127.0.0.1:{self.server.server_port}", "token")
        self.told = []
        self.watch = Watch(self.client, lambda _runs: None, self.told.append)
        self.addCleanup(thread.join)
        self.addCleanup(self.server.server_close)
        self.addCleanup(self.server.shutdown)
        self.addCleanup(self.client._forget)

    def test_so_many_goals_are_under_way_and_a_further_one_is_rejected_with_the_reason(self):
        goals = Goals(self.client, self.watch, None, self.told.append)
        asked = Asked(Machine("p", "m", ""), {}, "a/action/B", lambda *_result: {}, lambda *_feedback: None)
        accept = goals.accept("/run", lambda _goal: asked)
        given = [object() for _ in range(9)]
        self.assertEqual([accept(goal) for goal in given], [True] * 8 + [False])
        self.assertEqual((len(self.server.runs), len(self.told)), (8, 1))
        self.assertTrue(self.told[0].startswith("a goal of /run is rejected: 8 goals are under way, and there are no more at a time"))
        self.server.runs[0]["phase"] = "finished"
        self.server.runs[0]["outcome"] = {"name": "aborted"}
        self.watch.look()
        with self.assertRaises(GoalAborted):
            goals.work(types.SimpleNamespace(goal=given[0], canceled=False))
        self.assertEqual([accept(goal) for goal in (object(), object())], [True, False])

    def result(self, ask, outputs):
        """The result of a goal whose run ends with these outputs."""
        self.server.outputs = outputs
        goals = Goals(self.client, self.watch, lambda _type, values: values, self.told.append)
        goal = types.SimpleNamespace(machine="m", inputs="")
        self.assertTrue(goals.accept("/run", ask)(goal))
        self.server.runs[-1]["phase"] = "finished"
        self.watch.look()
        return goals.work(types.SimpleNamespace(goal=goal, canceled=False))

    def result_of_any(self, outputs):
        return self.result(lambda goal: _goals.run_machine(goal, "a/action/B", lambda name: Machine("p", name, "")), outputs)

    def test_outputs_of_which_there_are_views_are_named_to_the_client(self):
        view = {"__repr__": "a list of 50000 items", "__class__": "list", "__len__": 50_000, "__first__": [7]}
        pixels = {"__repr__": "array", "__shape__": [2], "__items__": [1, 2]}
        whole = {"count": 3, "pair": {"__tuple__": [1, "x"]}, "pixels": pixels}
        self.assertEqual(self.result_of_any(whole)["message"], "")
        outputs = {**whole, "cloud": view, "nested": {"a": [{"__tuple__": [view]}]}, "many": {**pixels, "__sampled__": [64]}}
        result = self.result_of_any(outputs)
        self.assertEqual(result["message"], "of the outputs cloud, nested, many the result has views: their values have no form in JSON")
        self.assertEqual(json.loads(result["outputs"]), outputs)

    def test_of_runs_that_are_over_the_newest_are_told_and_those_of_goals(self):
        self.server.runs = [run(f"r{number}", "finished") for number in range(22)] + [run("now", "live")]
        self.watch.followed.add("r21")
        self.assertEqual([each.id for each in self.watch.look()], [*(f"r{number}" for number in range(20)), "r21", "now"])

    def test_machines_are_looked_for_in_so_many_folders_in_folders(self):
        for levels, found in ((31, 1), (32, 0), (1000, 0), (0, 1)):
            with self.subTest(levels):
                self.server.levels = levels
                self.assertEqual(len(_machines.machines(self.client)), found)

    def test_an_error_shows_the_beginning_of_a_long_address(self):
        head = "/api/v1/runs/"
        for length in (200, 201):
            address = head + "x" * (length - len(head))
            shown = address if length == 200 else address[:200] + "…"
            with self.assertRaises(Refused) as caught:
                self.client.get("runs", address[len(head) :])
            self.assertEqual(str(caught.exception), f"GET {shown}: the server answers 404 Not Found")


if __name__ == "__main__":
    unittest.main()
