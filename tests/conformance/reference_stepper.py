"""Steps one machine in the reference (the PyPI package ``rafcon``) and prints after each command that it stands still.

Uses only the reference's public interface. What scripts do is written by the scripts themselves (see stepping.rs of
``cargo xtask``); this program only gives the commands and waits until nothing is written any more.
"""

import argparse
import os
import sys
import tempfile
import time

from reference_driver import configure, load

QUIET_S = 0.5

COMMANDS = {
    "into": "step_into",
    "over": "step_over",
    "out": "step_out",
    "back": "backward_step",
}


def wait_until_quiet(trace):
    """Returns when the file has not grown for a while."""
    size, since = -1, time.monotonic()
    while time.monotonic() - since < QUIET_S:
        now = os.path.getsize(trace)
        if now != size:
            size, since = now, time.monotonic()
        time.sleep(0.01)


def mark(trace, text):
    with open(trace, "a", encoding="utf-8") as file:
        file.write(text + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("machine", help="folder of the state machine")
    parser.add_argument("commands", nargs="+", choices=sorted(COMMANDS))
    arguments = parser.parse_args()
    trace = os.environ["RAFCON_TRACE"]

    from rafcon.core.singleton import state_machine_execution_engine as engine
    from rafcon.core.singleton import state_machine_manager

    with tempfile.TemporaryDirectory() as folder:
        configure([], folder)
        machine = load(arguments.machine)
        number = machine.state_machine_id
        state_machine_manager.active_state_machine_id = number
        engine.step_mode(number)
        wait_until_quiet(trace)
        for command in arguments.commands:
            mark(trace, "= " + command)
            getattr(engine, COMMANDS[command])()
            wait_until_quiet(trace)
            if engine.finished_or_stopped():
                break
        mark(trace, "= ended" if engine.finished_or_stopped() else "= stands")
    sys.stdout.flush()
    os._exit(0)


if __name__ == "__main__":
    main()
