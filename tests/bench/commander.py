"""Starts a run of the commanded machine, preempts its state again and again over the run's socket, and prints how long
after the command was sent the script went on, in milliseconds.

Usage: ``commander.py RUNS PROGRAM ARGUMENT…``: the program runs the machine and keeps the run below the folder ``RUNS``. The
machine writes ``{"woken": […]}``, on the clock that all processes of the machine share, to the file that
``RAFCON_BENCH_ANSWER`` names.
"""

import glob
import json
import os
import socket
import subprocess
import sys
import time
from pathlib import Path

sys.path.append(str(Path(__file__).parents[2] / "crates/python/tests"))
from event_stream import EventStream  # noqa: E402

STATE = "ROOT/WAIT"


def connect(runs):
    """The socket of the only run, once there is one."""
    while True:
        for path in glob.glob(os.path.join(runs, "*", "socket")):
            talk = socket.socket(socket.AF_UNIX)
            try:
                talk.connect(path)
                return talk
            except OSError:
                talk.close()
        time.sleep(0.01)


def preempt(talk):
    """Preempts the state each time it is entered; gives the times when the commands were sent."""
    incoming = talk.makefile("rb")
    hello = json.loads(incoming.readline())
    send(talk, hello)
    stream = EventStream(incoming)
    send(talk, {"message": "join", "from": 1, "every_event": True})
    sent = []
    while message := stream.next():
        event = message.get("event", {})
        if message["message"] == "event" and event["type"] == "entered" and event["path"] == STATE:
            command = {"type": "preempt", "path": STATE}
            envelope = {"message": "command", "id": str(len(sent)), "author": "bench", "command": command}
            sent.append(time.perf_counter_ns())
            send(talk, envelope)
    return sent


def send(talk, message):
    talk.sendall(json.dumps(message).encode() + b"\n")


def main():
    runs, *program = sys.argv[1:]
    with subprocess.Popen(program, stdout=subprocess.DEVNULL) as run:
        sent = preempt(connect(runs))
    if run.returncode != 0:
        sys.exit(f"the run ended with {run.returncode}")
    with open(os.environ["RAFCON_BENCH_ANSWER"], encoding="utf-8") as file:
        woken = json.load(file)["woken"]
    json.dump({"times_ms": [(end - begin) / 1e6 for begin, end in zip(sent, woken)]}, sys.stdout)


if __name__ == "__main__":
    main()
