"""Starts a program and prints how long after that its answer was taken, in milliseconds.

Usage: ``stopwatch.py PROGRAM ARGUMENT…``. The program writes ``{"first_ns": …}``, on the clock that all processes of the
machine share, to the file that ``RAFCON_BENCH_ANSWER`` names.
"""

import json
import os
import subprocess
import sys
import time


def main():
    began = time.perf_counter_ns()
    subprocess.run(sys.argv[1:], stdout=subprocess.DEVNULL, check=True)
    with open(os.environ["RAFCON_BENCH_ANSWER"], encoding="utf-8") as file:
        first = json.load(file)["first_ns"]
    json.dump({"times_ms": [(first - began) / 1e6]}, sys.stdout)


if __name__ == "__main__":
    main()
