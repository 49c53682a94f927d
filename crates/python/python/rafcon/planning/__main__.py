"""Engines of unified-planning as programs.

``python -m rafcon.planning --engine NAME DOMAIN PROBLEM`` prints a plan as one line of JSON. The
exit status is 10 if there is no plan, 14 if none was found, and 13 if the engine is missing or does
not support the problem.

Ends when standard input closes, because then the program that started it has ended.
"""

import argparse
import json
import os
import signal
import sys
import threading


def end_with_parent():
    """Kill the process group when standard input ends: the program that started it has ended."""
    while os.read(0, 65536):
        pass
    os.killpg(os.getpgrp(), signal.SIGKILL)


def steps_of(plan):
    """Steps of a plan, with times if the plan has times."""
    if hasattr(plan, "timed_actions"):
        for start, action, duration in plan.timed_actions:
            step = {"time": float(start), "action": words(action)}
            if duration is not None:
                step["duration"] = float(duration)
            yield step
        return
    actions = plan.actions if hasattr(plan, "actions") else plan.convert_to(plan_kind().SEQUENTIAL_PLAN).actions
    for action in actions:
        yield {"action": words(action)}


def plan_kind():
    """Enum ``PlanKind``, imported on first use."""
    from unified_planning.plans import PlanKind

    return PlanKind


def words(action):
    """Action with its objects, in the syntax of PDDL."""
    return "(%s)" % " ".join([action.action.name, *map(str, action.actual_parameters)])


def tell(plan):
    """Print a plan as one line."""
    steps = list(steps_of(plan))
    temporal = hasattr(plan, "timed_actions")
    print(json.dumps({"temporal": temporal, "steps": steps}), flush=True)


def solve(planner, problem, options):
    """Print plans; return the exit status."""
    from unified_planning.engines.results import PlanGenerationResultStatus as Status

    if options.anytime and hasattr(planner, "get_solutions") and planner.is_anytime():
        found = False
        for result in planner.get_solutions(problem, timeout=options.time_limit):
            if result.plan is not None:
                found = True
                tell(result.plan)
        return 0 if found else 14
    result = planner.solve(problem, timeout=options.time_limit)
    if result.plan is not None:
        tell(result.plan)
        return 0
    if result.status == Status.UNSOLVABLE_PROVEN:
        return 10
    return 13 if result.status == Status.UNSUPPORTED_PROBLEM else 14


def main():
    """Plan with the options of the command line; return the exit status."""
    parser = argparse.ArgumentParser(prog="python -m rafcon.planning", description="plans with an engine of unified-planning")
    parser.add_argument("--engine", required=True, help="its name, such as fast-downward, pyperplan or aries")
    parser.add_argument("--time-limit", type=float, help="in seconds")
    parser.add_argument("--anytime", action="store_true", help="look for better plans until then")
    parser.add_argument("domain")
    parser.add_argument("problem")
    options = parser.parse_args()
    if not sys.stdin.isatty() and os.getpgrp() == os.getpid():
        threading.Thread(target=end_with_parent, daemon=True).start()
    try:
        from unified_planning.io import PDDLReader
        from unified_planning.shortcuts import AnytimePlanner, OneshotPlanner, get_environment
    except ImportError:
        print("unified-planning is not there for %s: pip install unified-planning" % sys.executable, file=sys.stderr)
        return 13
    get_environment().credits_stream = None
    try:
        problem = PDDLReader().parse_problem(options.domain, options.problem)
        make = AnytimePlanner if options.anytime else OneshotPlanner
        with make(name=options.engine) as planner:
            return solve(planner, problem, options)
    except Exception as error:
        if type(error).__name__ == "UPNoRequestedEngineAvailableException":
            print("unified-planning has no engine `%s`: pip install unified-planning[%s]" % (options.engine, options.engine), file=sys.stderr)
            return 13
        print("%s: %s" % (type(error).__name__, " ".join(str(error).split())), file=sys.stderr)
        return 13


if __name__ == "__main__":
    sys.exit(main())
