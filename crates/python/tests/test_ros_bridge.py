"""The bridge to ROS without ROS: goals as inputs, runs as results, feedback and states, names of machines."""

import array
import http.server
import json
import math
import random
import threading
import types
import unittest
import urllib.parse

import stage  # noqa: F401, it brings the package
from building import call
from rafcon.ros.bridge import _machines, _mapping, _markers, _state
from rafcon.ros.bridge._client import Client, NoAnswer, Refused
from rafcon.ros.bridge._goals import Refusal, inputs_of_text
from rafcon.ros.bridge._machines import Machine
from rafcon.ros.bridge._mapping import Unfit
from rafcon.ros.bridge._watch import RunNow


def snapshot(*active):
    return {"status": "running", "active": [{"path": path, "name": name} for path, name in active]}


class Mapping(unittest.TestCase):
    def test_a_goal_is_inputs(self):
        goal = {"place": "kitchen", "pose": {"x": 1.5, "y": 2.0}, "ids": array.array("i", [1, 2]), "raw": b"\x01\xff", "other": 3}
        inputs = _mapping.inputs_of(goal, {"place", "pose", "ids", "raw"})
        self.assertEqual(inputs, {"place": "kitchen", "pose": {"x": 1.5, "y": 2.0}, "ids": [1, 2], "raw": [1, 255]})

    def test_what_json_has_not_is_refused(self):
        for value in (math.nan, math.inf):
            with self.assertRaisesRegex(Unfit, r"pose\.x is (nan|inf), which cannot be an input of a run: send a finite number"):
                _mapping.inputs_of({"pose": {"x": value}}, {"pose"})

    def test_outputs_are_a_result(self):
        fields = {"sequence": False, "pair": False, "outcome": True, "run": True, "message": True, "pose": False}
        outputs = {"sequence": [1, 2], "pair": {"__tuple__": [1, {"__tuple__": []}]}, "more": 3, "pose": None}
        result = _mapping.result_of(fields, "r1", "success", outputs)
        self.assertEqual(result, {"sequence": [1, 2], "pair": [1, []], "outcome": "success", "run": "r1", "message": ""})

    def test_an_output_goes_before_what_is_known_of_the_run(self):
        self.assertEqual(_mapping.result_of({"outcome": True}, "r1", "success", {"outcome": "mine"}), {"outcome": "mine"})

    def test_a_number_is_never_told_in_words(self):
        self.assertEqual(_mapping.result_of({"outcome": False, "run": False}, "r1", "success", {}), {})

    def test_what_the_server_does_not_tell_whole_is_no_result(self):
        whole = {"__repr__": "array([1, 2])", "__shape__": [2], "__items__": [1, 2]}
        self.assertEqual(_mapping.value_of(whole, "ids"), [1, 2])
        for part in ({**whole, "__sampled__": [64]}, {"__repr__": "[1, 2…", "__len__": 1000, "__first__": [1]}, {"__repr__": "nan"}):
            with self.assertRaisesRegex(Unfit, "the output `ids` is .*: have the machine give numbers"):
                _mapping.value_of(part, "ids")

    def test_active_states_are_the_innermost_by_their_names(self):
        now = snapshot(("R", "Mission"), ("R/A", "Fetch"), ("R/A/B", "Grip"), ("R/C", ""))
        self.assertEqual(_mapping.active_states(now), ["Mission/Fetch/Grip", "Mission/C"])
        self.assertEqual(_mapping.active_states(None), [])

    def test_feedback_has_what_its_type_has(self):
        active = ["M/A", "M/B"]
        self.assertEqual(_mapping.feedback_of({"active": True, "run": False}, "r1", active), {"active": active, "run": "r1"})
        self.assertEqual(_mapping.feedback_of({"active_states": False}, "r1", active), {"active_states": "M/A, M/B"})
        self.assertIsNone(_mapping.feedback_of({"run": False}, "r1", active))

    def test_what_a_machine_does_not_have_is_told(self):
        said = _mapping.complaints("/fetch", ["place", "speed"], ["item", "outcome", "cost"], {"place"}, {"item"})
        self.assertEqual(
            said,
            [
                "the goal of /fetch has a field `speed`, and the machine no input of that name",
                "the result of /fetch has a field `cost`, and the machine no output of that name",
            ],
        )

    def test_inputs_of_run_machine_are_an_object_of_json(self):
        self.assertEqual(inputs_of_text(" "), {})
        self.assertEqual(inputs_of_text('{"a": [1, null]}'), {"a": [1, None]})
        for text, why in (
            ("[1]", "no object"),
            ("{", "no JSON"),
            ('{"a": NaN}', "NaN is no value of JSON"),
            ('{"a": 1e999}', "1e999 is too large for a number of 64 bits"),
            ('{"a": -1e999}', "-1e999 is too large"),
            ('{"a": ' + "[" * 101 + "]" * 101 + "}", "more than 100 levels"),
            ("[" * 100_000 + "]" * 100_000, "more than 100 levels"),
        ):
            with self.assertRaisesRegex(Refusal, why):
                inputs_of_text(text)
        self.assertEqual(inputs_of_text('{"a": ' + "[" * 50 + "1.5" + "]" * 50 + "}").keys(), {"a"})

    def test_inputs_may_have_so_many_levels(self):
        for lists in (98, 99, 100):
            text = '{"a": ' + "[" * lists + "]" * lists + "}"
            if lists < 100:
                self.assertEqual(inputs_of_text(text).keys(), {"a"})
            else:
                with self.assertRaisesRegex(Refusal, "more than 100 levels"):
                    inputs_of_text(text)


class Asked(http.server.BaseHTTPRequestHandler):
    """Answers each request with the parts of its path; closes the connection after those that are too long, and says so."""

    protocol_version = "HTTP/1.1"
    wbufsize = -1

    def answer(self):
        self.rfile.read(int(self.headers.get("Content-Length", 0)))
        if len(self.path) > 10_000:
            self.send_response(414)
            self.send_header("Connection", "close")
            body = b"too long"
        else:
            self.send_response(200)
            body = json.dumps(self.path.split("/")).encode()
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    do_GET = do_POST = answer  # noqa: N815, the names are those of the base class

    def log_message(self, *_arguments):
        pass


class Requests(unittest.TestCase):
    def setUp(self):
        server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Asked)
        server.daemon_threads = True
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        self.client = Client(f"http://127.0.0.1:{server.server_port}", "token")
        self.addCleanup(thread.join)
        self.addCleanup(server.server_close)
        self.addCleanup(server.shutdown)
        self.addCleanup(self.client._forget)

    def test_a_name_is_one_part_of_an_address_whatever_it_is(self):
        dice = random.Random(7)
        characters = "/?#%&=+.;: \\\t\r\n\0\"'ü漢😀a"
        names = ["r/resume?x=", "r/values/1/fetch?x=", "../runs", "a b", "ü", "r%2Fresume", "r\r\nHost: x"]
        names += ["".join(dice.choices(characters, k=dice.randint(1, 12))) for _ in range(300)]
        for name in names:
            path = self.client.post(("runs", name, "commands"), {})
            self.assertEqual([urllib.parse.unquote(part) for part in path], ["", "api", "v1", "runs", name, "commands"])
            self.assertEqual(self.client.get("runs", name), path[:-1])

    def test_the_client_goes_on_after_an_answer_that_closes_the_connection(self):
        for _ in range(3):
            # The kernel drops the answer of a server that closes a connection with unread bytes, at times.
            with self.assertRaisesRegex((Refused, NoAnswer), "answers 414 |does not answer"):
                self.client.post(("runs", "x" * 100_000, "commands"), {})
            self.assertEqual(self.client.get("runs", "r1")[-1], "r1")


class Machines(unittest.TestCase):
    def test_a_goal_names_a_machine(self):
        known = [Machine("p", "arm/fetch", ""), Machine("p", "dock", ""), Machine("q", "base/dock", "")]
        chosen = lambda text: getattr(_machines.chosen(known, text), "name", None) or _machines.chosen(known, text)  # noqa: E731
        self.assertEqual(chosen("p/arm/fetch"), "p/arm/fetch")
        self.assertEqual(chosen("fetch"), "p/arm/fetch")
        self.assertEqual(chosen("p/dock"), "p/dock")
        self.assertEqual(chosen("dock"), "`dock` can be p/dock or q/base/dock: write one of these")
        self.assertEqual(chosen("etch"), "there is no machine `etch`; there are p/arm/fetch, p/dock, q/base/dock")
        self.assertEqual(chosen(""), "there is no machine ``; there are p/arm/fetch, p/dock, q/base/dock")

    def declared(self, *semantics):
        """What a machine with these semantic data of its root declares, line by line."""
        program = f"""
            from rafcon.ros.bridge import _machines
            for number, semantic in enumerate({semantics!r}):
                root = HierarchyState("Fetch")
                root.add_input_data_port("place", str, "here")
                root.add_output_data_port("item", str, "")
                for name, value in semantic.items():
                    root.semantic_data[name] = value
                folder = f"{{os.environ['OUT']}}/fetch{{number}}"
                storage.save_state_machine_to_path(StateMachine(root), folder)
                try:
                    found = _machines.declared(_machines.Machine("p", "arm/fetch", folder))
                    print(found and (found.action, found.type, *found.inputs, *found.outputs))
                except _machines.WrongDeclaration as error:
                    print(error)
        """
        return call(program).splitlines()

    def test_a_machine_declares_an_action(self):
        found = self.declared({"ros": {"action": {"name": "/fetch", "type": "m/action/Fetch"}}}, {"ros": {"action": {"type": "m/action/Fetch"}}})
        self.assertEqual(found, ["('/fetch', 'm/action/Fetch', 'place', 'item')", "('fetch', 'm/action/Fetch', 'place', 'item')"])

    def test_most_machines_declare_none(self):
        self.assertEqual(self.declared({}, {"ros": {"topic": "x"}, "other": "y"}), ["None", "None"])
        self.assertIsNone(_machines.declared(Machine("p", "gone", "/nowhere/at/all")))

    def test_a_wrong_declaration_is_told(self):
        for found in self.declared({"ros": {"action": "fetch"}}, {"ros": {"action": {"name": "fetch"}}}):
            self.assertIn("the semantic data ros.action of p/arm/fetch has no `type`: write", found)


def run_now(snapshot=None, **summary):
    return RunNow({"id": "r1", "name": "Fetch", "machine": {"project": "p", "path": "fetch"}, "events": 3, **summary}, snapshot)


class Markers(unittest.TestCase):
    def test_each_run_in_progress_has_a_text_and_no_two_overlap(self):
        paused = {**snapshot(("R", "Tidy")), "status": "paused"}
        runs = [
            run_now(snapshot(("R", "Fetch"), ("R/A", "Grip")), phase="live"),
            run_now(phase="finished", outcome={"id": 0, "name": "success"}),
            run_now(paused, phase="live", id="r2"),
        ]
        cleared, fetch, tidy = _markers.markers_of(runs, "base_link", {"sec": 7, "nanosec": 0})["markers"]
        self.assertEqual(cleared["action"], 3)
        self.assertEqual([fetch["text"], tidy["text"]], ["p/fetch: running\nFetch/Grip", "p/fetch: paused\nTidy"])
        self.assertEqual([each["header"]["frame_id"] for each in (fetch, tidy)], ["base_link"] * 2)
        self.assertNotEqual(fetch["id"], tidy["id"])
        between_m = tidy["pose"]["position"]["z"] - fetch["pose"]["position"]["z"]
        self.assertGreaterEqual(between_m, 2 * fetch["scale"]["z"])

    def test_without_a_run_nothing_is_left(self):
        self.assertEqual(len(_markers.markers_of([], "base_link", {})["markers"]), 1)


class State(unittest.TestCase):
    def status(self, snapshot=None, **summary):
        found = _state.status_of(run_now(snapshot, **summary))
        return types.SimpleNamespace(**{**found, "values": [(each["key"], each["value"]) for each in found["values"]]})

    def test_a_run_in_progress_says_where_it_is(self):
        found = self.status(snapshot(("R", "Fetch"), ("R/A", "Grip")), phase="live")
        self.assertEqual((found.level, found.name, found.message, found.hardware_id), (_state.OK, "rafcon: p/fetch", "running: Fetch/Grip", "r1"))
        self.assertIn(("active", "Fetch/Grip"), found.values)

    def test_levels(self):
        paused = {**snapshot(("R", "Fetch")), "status": "paused"}
        self.assertEqual(self.status(paused, phase="live").level, _state.WARN)
        self.assertEqual(self.status(phase="crashed").level, _state.ERROR)
        outcomes = {name: self.status(phase="finished", outcome={"id": 0, "name": name}) for name in ("success", "preempted", "aborted")}
        self.assertEqual([each.level for each in outcomes.values()], [_state.OK, _state.WARN, _state.ERROR])
        self.assertEqual(outcomes["success"].message, "finished: success")


if __name__ == "__main__":
    unittest.main()
