"""Measures ``rafcon.ros`` against a real peer, one line of JSON for each figure: ``cargo xtask ros`` prints them as a table."""

import json
import pathlib
import random
import statistics
import sys
import tempfile
import threading
import time

import peers  # noqa: F401, it says where the package and `support` lie
import support
from peers import Direct, Peer
from support import Runner, container, save, script, sequence

#: A run of a thousand preemptions takes its time.
support.STUCK_S = 600
COUNT = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
#: Runs that are started, kills, and cancellations that are timed.
STARTS, KILLS, CANCELS = 10, 4, 100
#: Rounds of calls, and calls in each.
ROUNDS, CALLS = 9, 200


def bar(name, value, limit, better, unit=""):
    good = {"most": value <= limit, "least": value >= limit, "is": value == limit}[better]
    print(json.dumps({"name": name, "value": round(value, 3), "limit": limit, "better": better, "unit": unit, "met": good}), flush=True)


def lost(peer):
    """Messages, calls and goals, both directions: how many did not come through."""
    from rafcon import ros

    texts = [str(number) for number in range(COUNT)]
    missing = {}
    peer.subscribe("/bars/there")
    for text in texts:
        ros.publish("/bars/there", text, "std_msgs/String", qos=COUNT)
    missing["messages to the peer"] = COUNT - len(set(peer.heard("/bars/there", COUNT)))
    with ros.subscribe("/bars/back", "std_msgs/String", qos=COUNT) as heard:
        peer.publish("/bars/back", [])
        peer.subscribers("/bars/back", 1)
        peer.publish("/bars/back", texts)
        missing["messages from the peer"] = COUNT - len({heard.next(20).data for _ in texts})
    missing["calls to the peer"] = COUNT - sum(ros.call("/peer/echo", {"int32_value": number}, timeout=20)["int32_value"] == number for number in range(COUNT))
    with ros.serve("/bars/serve", lambda _request: {"success": True, "message": "x"}, "std_srvs/Trigger"):
        missing["calls from the peer"] = COUNT - peer.call("/bars/serve", COUNT).count([True, "x"])
    missing["goals to the peer"] = COUNT - sum(ros.action("/peer/quick", 5).outcome == "succeeded" for _ in range(COUNT))
    with ros.action_server("/bars/act", lambda goal: {"sequence": [goal.goal.order]}, "test_msgs/Fibonacci"):
        missing["goals from the peer"] = COUNT - peer.goals("/bars/act", 3, COUNT).count(4)
    for what, number in missing.items():
        if number:
            print(f"lost: {number} {what}", file=sys.stderr)
    bar("ros_lost", sum(missing.values()), 0, "is")


def speed():
    """Calls a second, of ``ros.call`` against a script that uses ``rclpy`` itself: median of rounds that alternate."""
    from rafcon import ros

    with Direct("/peer/set") as direct:

        def ours():
            begin_s = time.perf_counter()
            for _ in range(CALLS):
                ros.call("/peer/set", True)
            return CALLS / (time.perf_counter() - begin_s)

        ours(), direct.rate(CALLS)
        rounds = [(ours(), direct.rate(CALLS)) for _ in range(ROUNDS)]
    bar("ros_calls_per_s", statistics.median(each for each, _ in rounds), 0, "least", "/s")
    bar("ros_calls_against_rclpy", statistics.median(one / two for one, two in rounds), 0.9, "least")


def first_messages(peer, folder):
    """From the start of a run's process to its first message at the peer."""
    text = "from rafcon import ros\ndef execute(self, inputs, outputs, gvm):\n    ros.publish('/bars/first', 'x', 'std_msgs/String')\n    return 0\n"
    machine = save(folder / "first", sequence(script(text)))
    peer.subscribe("/bars/first")
    times = []
    for number in range(STARTS):
        begin_s = time.monotonic()
        runner = Runner(machine)
        peer.heard("/bars/first", number + 1)
        times.append(time.monotonic() - begin_s)
        runner.finish()
    bar("ros_first_message_s", statistics.median(times), 2, "most", "s")
    bar("ros_first_message_max_s", max(times), 2, "most", "s")


_GOAL = """
import time
from rafcon import ros
def execute(self, inputs, outputs, gvm):
    gvm.set_variable("told", None, per_reference=True)
    ros.action("/peer/forever", 5, feedback=lambda message: gvm.set_variable("told", True, per_reference=True))
    return 0
"""
_TIMED = """
import time
def execute(self, inputs, outputs, gvm):
    while not gvm.get_variable("told", per_reference=True):
        if self.preemptive_wait(0.002):
            return "preempted"
    gvm.set_variable("times", [*gvm.get_variable("times", default=[]), time.monotonic()])
    return 0
"""
_RANDOM = """
import random
def execute(self, inputs, outputs, gvm):
    self.preemptive_wait(random.expovariate(100))
    return 0
"""
_COUNT = """
def execute(self, inputs, outputs, gvm):
    gvm.set_variable("n", gvm.get_variable("n", default=0) + 1)
    if gvm.get_variable("n") < %d:
        return "again"
    print(gvm.get_variable("times", default=[]))
    return "success"
"""


def preempted(folder, name, other, count):
    """A run in which a goal is preempted so often; the times that the other branch noted."""
    inner = container("preemptive", [script(_GOAL, "G"), script(other, "O")], [("G", 0, 0), ("O", 0, 0)], id="P")
    counter = script(_COUNT % count, "C", outcomes=("success", "again"))
    root = container("hierarchy", [inner, counter], [(None, None, "P"), ("P", 0, "C"), ("C", 1, "P"), ("C", 0, 0)])
    result = Runner(save(folder / name, root)).finish()
    assert result.outcome == "success", result.logged()[-5:]
    return json.loads(result.logged("stdout")[-1])


def preemptions(peer, folder):
    """How long until the peer hears of a preemption, and what stays of goals."""
    times = preempted(folder, "timed", _TIMED, CANCELS)
    cancelled = peer.cancelled()[-len(times) :]
    waits = sorted((after - before) * 1000 for before, after in zip(times, cancelled))
    bar("ros_cancel_ms", waits[len(waits) // 2], 50, "most", "ms")
    bar("ros_cancel_max_ms", waits[-1], 50, "most", "ms")
    before = peer.counted("forever accepted", 0)
    preempted(folder, "random", _RANDOM, COUNT)
    print(f"{peer.counted('forever accepted', 0) - before} of {COUNT} preempted goals had been accepted", file=sys.stderr)
    bar("ros_orphan_goals", peer.open("forever"), 0, "is")


def kills():
    """From the death of a server to the outcome of who waits for it."""
    from test_peer import heard_of

    from rafcon import ros

    ends = []
    for number in range(KILLS):
        peer = Peer()
        died = []
        what = ("never called", "forever accepted")[number % 2]

        def kill(peer=peer, died=died, what=what):
            peer.counted(what)
            heard_of(peer)
            died.append(time.monotonic())
            peer.kill()

        killer = threading.Thread(target=kill)
        killer.start()
        if number % 2:
            assert ros.action("/peer/forever", 5, find=20).outcome == "aborted"
        else:
            try:
                ros.call("/peer/never", timeout=60, find=20)
            except ros.NoServer:
                pass
        ends.append(time.monotonic() - died[0] if died else 60)
        killer.join()
    bar("ros_killed_s", max(ends), 2, "most", "s")
    begin_s = time.monotonic()
    ros.action("/bars/nobody", 5)
    bar("ros_missing_s", time.monotonic() - begin_s, 2, "most", "s")


def main():
    from rafcon import ros

    random.seed(1)
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        peer = Peer()
        lost(peer)
        speed()
        ros.close()
        first_messages(peer, folder)
        preemptions(peer, folder)
        peer.close()
        kills()
        ros.close()


if __name__ == "__main__":
    main()
