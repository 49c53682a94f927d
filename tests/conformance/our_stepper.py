"""Steps one machine by ``rafcon run`` and ``rafcon tell``, as ``reference_stepper.py`` steps it in the reference."""

import argparse
import os
import subprocess
import sys
import tempfile
import time

from reference_stepper import COMMANDS, mark, wait_until_quiet

PATIENCE_S = 20.0

TOLD = {"into": "step_into", "over": "step_over", "out": "step_out", "back": "step_back"}


def wait_for_socket(run, runs):
    """Returns when the run can be joined."""
    begun = time.monotonic()
    while not any(os.path.exists(os.path.join(runs, name, "socket")) for name in os.listdir(runs)):
        if run.poll() is not None or time.monotonic() - begun > PATIENCE_S:
            raise SystemExit("the run did not begin to listen")
        time.sleep(0.01)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("rafcon", help="the program")
    parser.add_argument("machine", help="folder of the state machine")
    parser.add_argument("commands", nargs="+", choices=sorted(COMMANDS))
    arguments = parser.parse_args()
    trace = os.environ["RAFCON_TRACE"]

    with tempfile.TemporaryDirectory() as runs:
        environment = dict(os.environ, RAFCON_RUNS=runs)
        words = [arguments.rafcon, "run", arguments.machine, "--hold", "--python", sys.executable]
        run = subprocess.Popen(words, env=environment, stdout=subprocess.DEVNULL, stdin=subprocess.DEVNULL)
        try:
            wait_for_socket(run, runs)
            for command in arguments.commands:
                mark(trace, "= " + command)
                subprocess.run([arguments.rafcon, "tell", "last", TOLD[command]], env=environment, check=True)
                wait_until_quiet(trace)
                if run.poll() is not None:
                    break
            mark(trace, "= stands" if run.poll() is None else "= ended")
        finally:
            run.terminate()
            run.wait()


if __name__ == "__main__":
    main()
