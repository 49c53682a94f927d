"""Goals: each begins a run, follows it to its end, and stops it after a cancellation."""

import json
import math
import threading
import time
import uuid
from dataclasses import dataclass

from rafcon.ros import GoalAborted
from rafcon.ros.bridge import _machines, _mapping
from rafcon.ros.bridge._client import NoAnswer, Refused
from rafcon.ros.bridge._mapping import Unfit

#: Maximum number of concurrent goals; each has a thread of its own, and a runner.
GOALS_MAX = 8
#: Maximum nesting of lists and objects in `inputs`; the server parses 127.
DEPTH_MAX = 100
_TOO_DEEP = f"`inputs` has more than {DEPTH_MAX} levels of lists and objects: send fewer"
#: Timeout (s) for loading a machine.
_START_S = 130.0
#: Interval (s) at which a goal checks for cancellation.
_LOOK_S = 0.02
#: Time (s) in which a restarted runner may follow a dead one.
_CRASHED_S = 1.0
#: A run missing from the status for this time (s) is lost.
_MISSING_S = 10.0
#: Outcomes that count as failures.
_FAILURES = ("aborted", "preempted")


@dataclass
class Asked:
    """Request of a goal, and functions for its result and feedback."""

    machine: object
    inputs: dict
    #: The type of its action.
    type: str
    #: ``result(run, outcome, outputs, words)`` and ``feedback(run, active)`` return fields; None if there is no feedback.
    result: object
    feedback: object


class Refusal(Exception):
    """A goal is rejected; the message gives the reason."""


class Goals:
    """Goals of all actions."""

    def __init__(self, client, watch, build, tell):
        self._client = client
        #: ``build(type, values)`` makes a message, or raises an error with the reason.
        self._build = build
        self._watch = watch
        self._tell = tell
        self._lock = threading.Condition()
        self._count = 0
        self._begun = {}
        #: Reason why goals are no longer accepted, or None.
        self.over = None

    def accept(self, action, ask):
        """Create the ``accept`` function of an action: it begins the run of the goal.

        ``ask(goal)`` returns the :class:`Asked`, or raises an exception to reject the goal.
        """

        def accept(goal):
            try:
                self._enter()
            except Refusal as refusal:
                self._tell(f"a goal of {action} is rejected: {refusal}")
                return False
            try:
                asked = ask(goal)
                self._begun[id(goal)] = asked, self._start(asked)
                return True
            except (Refusal, Unfit, Refused, NoAnswer) as error:
                self._leave()
                self._tell(f"a goal of {action} is rejected: {error}")
                return False
            except BaseException:
                self._leave()
                raise

        return accept

    def _enter(self):
        with self._lock:
            if self.over is not None:
                raise Refusal(self.over)
            if self._count >= GOALS_MAX:
                raise Refusal(f"{GOALS_MAX} goals are under way, and there are no more at a time: wait for one to end, or cancel one")
            self._count += 1

    def _leave(self):
        with self._lock:
            self._count -= 1
            self._lock.notify_all()

    def _start(self, asked):
        for run in self._watch.look():
            if run.is_live and not run.robot and run.holder not in (None, "ros"):
                raise Refusal(
                    f"{run.holder} holds control of the run {run.id}, which is in progress: goals are accepted when they have released "
                    "control, or the run is over"
                )
        machine = {"project": asked.machine.project, "path": asked.machine.path}
        body = {"id": f"ros-{uuid.uuid4().hex}", "machine": machine, "inputs": asked.inputs}
        run = self._client.post(("runs",), body, _START_S)["id"]
        self._watch.followed.add(run)
        self._watch.now()
        return run

    def work(self, received):
        """Callback of an action: follow the run to its end."""
        asked, run = self._begun.pop(id(received.goal))
        try:
            return self._follow(received, asked, run)
        finally:
            self._watch.followed.discard(run)
            self._leave()

    def _follow(self, received, asked, run):
        told, stopping, crashed_s, seen_s = None, False, None, time.monotonic()
        while self.over is None:
            now = self._watch.find(run)
            if received.canceled and not stopping:
                stopping = True
                self._stop(run)
            if now is not None and now.phase == "finished":
                return self._ended(received, asked, now)
            is_gone = now is not None and not now.is_live
            crashed_s = (crashed_s or time.monotonic()) if is_gone else None
            if is_gone and time.monotonic() - crashed_s >= _CRASHED_S:
                words = f"the process of the run {run} has died: resume it with `rafcon resume {run}`, or send the goal again"
                raise self._aborted(asked, run, "", {}, words)
            seen_s = time.monotonic() if now is not None or self._watch.is_blind else seen_s
            if time.monotonic() - seen_s >= _MISSING_S:
                raise self._aborted(asked, run, "", {}, f"the server has no run {run} any more: somebody has deleted it")
            if now is not None and now.active != told:
                told = now.active
                feedback = asked.feedback(run, list(told))
                if feedback is not None:
                    received.feedback(feedback)
            self._watch.wait(_LOOK_S)
        raise self._aborted(asked, run, "", {}, f"{self.over}; the run {run} goes on without it")

    def _stop(self, run):
        try:
            command = {"id": f"ros-{uuid.uuid4().hex}", "command": {"type": "stop"}}
            self._client.post(("runs", run, "commands"), command, _START_S)
        except (Refused, NoAnswer) as error:
            # An ended run needs no stop; otherwise wait for its end.
            self._tell(f"the run {run} is not stopped by the cancelled goal: {error}")
        self._watch.now()

    def _ended(self, received, asked, now):
        try:
            outputs = self._outputs(now)
            # Build it here, so that the client receives an error if it does not fit.
            result = asked.result(now.id, now.outcome, outputs, "")
            self._build(asked.type + "_Result", result)
        except (Unfit, Refused, NoAnswer, TypeError, ValueError) as error:
            words = f"the run {now.id} ended with the outcome `{now.outcome}`, and its outputs are no result: {error}"
            raise self._aborted(asked, now.id, now.outcome, {}, words) from None
        if now.outcome in _FAILURES and not received.canceled:
            words = f"the run {now.id} ended with the outcome `{now.outcome}`"
            raise self._aborted(asked, now.id, now.outcome, outputs, words)
        return result

    def _outputs(self, now):
        return self._client.get("runs", now.id, "results")["outputs"]

    @staticmethod
    def _aborted(asked, run, outcome, outputs, words):
        return GoalAborted(words, asked.result(run, outcome, outputs, words))

    def end(self, why, seconds):
        """Abort all goals with a message; wait for their ends, at most ``seconds``."""
        self.over = why
        self._watch.close()
        with self._lock:
            self._lock.wait_for(lambda: self._count == 0, seconds)


def inputs_of_text(text):
    """Parse the inputs of ``run_machine``: a JSON object, or an empty text."""
    if not text.strip():
        return {}
    try:
        inputs = json.loads(text, parse_constant=_refuse_constant, parse_float=_finite)
    except ValueError as error:
        raise Refusal(f"`inputs` is no JSON: {error}") from error
    except RecursionError:
        raise Refusal(_TOO_DEEP) from None
    if _is_deep(inputs):
        raise Refusal(_TOO_DEEP)
    if not isinstance(inputs, dict):
        raise Refusal('`inputs` is JSON, and no object: write {"port": value, …}')
    return inputs


def _refuse_constant(text):
    raise ValueError(f"{text} is no value of JSON")


def _is_deep(value):
    level = [value]
    for _ in range(DEPTH_MAX):
        level = [each for parent in level for each in _children(parent)]
        if not level:
            return False
    return True


def _children(value):
    if isinstance(value, dict):
        return value.values()
    return value if isinstance(value, list) else ()


def _finite(text):
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(f"{text} is too large for a number of 64 bits")
    return value


def run_machine(goal, type_name, choose):
    """Return the :class:`Asked` of a goal of ``run_machine``."""
    machine = choose(goal.machine)
    if isinstance(machine, str):
        raise Refusal(machine)
    inputs = inputs_of_text(goal.inputs)
    wrong = _machines.check_inputs(machine, inputs)
    if wrong:
        raise Refusal(wrong)

    def result(run, outcome, outputs, words):
        words = "; ".join(filter(None, (words, _words_of_views(outputs))))
        return {"outcome": outcome, "outputs": json.dumps(outputs), "run": run, "message": words}

    return Asked(machine, inputs, type_name, result, lambda run, active: {"run": run, "active": active})


def _words_of_views(outputs):
    views = _mapping.views(outputs)
    return views and f"of the outputs {', '.join(views)} the result has views: their values have no form in JSON"


def of_declared(declared, type_name, result_fields, feedback_fields):
    """Create the ``ask`` function for the action that a machine declares."""

    def result(run, outcome, outputs, words):
        return _mapping.result_of(result_fields, run, outcome, outputs, words)

    def ask(goal):
        feedback = lambda run, active: _mapping.feedback_of(feedback_fields, run, active)  # noqa: E731
        return Asked(declared.machine, _mapping.inputs_of(goal, declared.inputs), type_name, result, feedback)

    return ask
