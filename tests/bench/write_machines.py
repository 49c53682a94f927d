"""Writes the machines that ``cargo xtask bench`` runs in both engines.

Usage: ``write_machines.py FOLDER``, with ``tests/conformance`` on the module path. Each machine measures itself and
writes its answer, a JSON object, to the file that the environment variable ``RAFCON_BENCH_ANSWER`` names: so neither
engine's protocol nor its start is part of the figure.
"""

import os
import sys

from machine_writer import DECIDER, barrier, decider, execution, hierarchy, preemptive, write

ANSWER = """
    import json, os, time
    def answer(**values):
        with open(os.environ['RAFCON_BENCH_ANSWER'], 'w') as file:
            json.dump(values, file)
"""
MARK = "import time\ngvm.set_variable({!r}, time.perf_counter_ns())\nreturn 0"
ROUNDS = 40


def _script(body):
    lines = [line[4:] for line in ANSWER.strip("\n").splitlines()]
    return "\n".join(lines + ["def execute(self, inputs, outputs, gvm):"] + [f"    {line}" for line in body.splitlines()])


def flat(loops):
    """Two states in a loop with an int counter."""
    end = f"nanoseconds = time.perf_counter_ns() - gvm.get_variable('began')\nanswer(states_per_s={2 * loops} / (nanoseconds / 1e9))\nreturn 0"
    return hierarchy(
        "ROOT",
        [
            execution("START", MARK.format("began")),
            execution(
                "COUNT",
                "outputs['count'] = inputs['count'] + 1\nreturn 0",
                inputs={"count": (int, 0)},
                outputs={"count": (int, 0)},
            ),
            execution(
                "CHECK",
                f"return 0 if inputs['count'] < {loops} else 1",
                inputs={"count": (int, 0)},
                outcomes=("again", "enough"),
            ),
            execution("END", _script(end)),
        ],
        ["-> START", "START.success -> COUNT", "COUNT.success -> CHECK", "CHECK.again -> COUNT", "CHECK.enough -> END",
         "END.success -> .success"],
        flows=["$count -> COUNT.count", "COUNT.count -> $count", "$count -> CHECK.count"],
        scoped={"count": (int, 0)},
    )


def race():
    """A preemptive state whose winner ends while four others wait, again and again; the times between both ends."""
    winner = "import time\nself.preemptive_wait(0.02)\ngvm.set_variable('won', time.perf_counter_ns())\nreturn 0"
    collect = (
        "late = time.perf_counter_ns() - gvm.get_variable('won')\n"
        "times = gvm.get_variable('times', default=[]) + [late / 1e6]\n"
        "gvm.set_variable('times', times)\n"
        "answer(times_ms=times)\n"
        f"return 0 if len(times) < {ROUNDS} else 1"
    )
    losers = [execution(f"WAIT{number}", "self.preemptive_wait(20)\nreturn 0") for number in range(4)]
    children = [execution("WIN", winner), *losers]
    contest = preemptive("RACE", children, [f"{child.state_id}.success -> .success" for child in children])
    return hierarchy(
        "ROOT",
        [contest, execution("COLLECT", _script(collect), outcomes=("again", "enough"))],
        ["-> RACE", "RACE.success -> COLLECT", "COLLECT.again -> RACE", "COLLECT.enough -> .success"],
    )


def gathering(children):
    """A barrier whose children do nothing, once."""
    idle = [execution(f"IDLE{number}", "return 0") for number in range(children)]
    arrivals = [f"{child.state_id}.success -> {DECIDER}" for child in idle]
    meeting = barrier("MEET", [*idle, decider("return 0")], [*arrivals, f"{DECIDER}.success -> .success"])
    end = "answer(times_ms=[(time.perf_counter_ns() - gvm.get_variable('began')) / 1e6])\nreturn 0"
    return hierarchy(
        "ROOT",
        [execution("START", MARK.format("began")), meeting, execution("END", _script(end))],
        ["-> START", "START.success -> MEET", "MEET.success -> END", "END.success -> .success"],
    )


def commanded():
    """A state that waits until a command preempts it, again and again, and says when it went on."""
    wait = (
        "self.preemptive_wait(20)\n"
        "gvm.set_variable('woken', gvm.get_variable('woken', default=[]) + [time.perf_counter_ns()])\n"
        "return 0"
    )
    collect = f"woken = gvm.get_variable('woken')\nanswer(woken=woken)\nreturn 0 if len(woken) < {ROUNDS} else 1"
    return hierarchy(
        "ROOT",
        [execution("WAIT", _script(wait)), execution("COLLECT", _script(collect), outcomes=("again", "enough"))],
        ["-> WAIT", "WAIT.success -> COLLECT", "WAIT.preempted -> COLLECT", "COLLECT.again -> WAIT",
         "COLLECT.enough -> .success"],
    )


def first():
    """One state that says when it runs, on the clock that all processes of the machine share."""
    return execution("ROOT", _script("answer(first_ns=time.perf_counter_ns())\nreturn 0"))


def main():
    folder = sys.argv[1]
    machines = {
        "flat": flat(200_000),
        "flat_for_reference": flat(1_000),
        "race": race(),
        "gathering": gathering(64),
        "first": first(),
        "commanded": commanded(),
    }
    for name, machine in machines.items():
        write(os.path.join(folder, name), machine)


if __name__ == "__main__":
    main()
