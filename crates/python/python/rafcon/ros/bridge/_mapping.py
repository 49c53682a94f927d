"""Mapping of goals to inputs of runs, and of runs to results. Independent of server and ROS."""

import array
import math
from collections.abc import Mapping

#: Names of result fields for the outcome, the run and a text, unless the machine has an output with that name.
OUTCOME, RUN, WORDS = "outcome", "run", ("message", "error_msg")
#: Names of feedback fields for the active states.
ACTIVE = ("active", "active_states")


class Unfit(Exception):
    """A value does not fit; the message names it and gives a remedy."""


def plain(value, where="the goal"):
    """Convert a field of a message to a JSON value; :class:`Unfit` for NaN and infinities."""
    if isinstance(value, Mapping):
        return {name: plain(each, f"{where}.{name}") for name, each in value.items()}
    if isinstance(value, (list, tuple, bytes, array.array)):
        return [plain(each, where) for each in value]
    if isinstance(value, float) and not math.isfinite(value):
        raise Unfit(f"{where} is {value}, which cannot be an input of a run: send a finite number")
    return value


def inputs_of(goal, ports):
    """Inputs of a run by port name, from the goal of an action that a machine declares."""
    return {name: plain(goal[name], name) for name in goal if name in ports}


def value_of(output, where):
    """Convert an output of a run from the server's encoding to a value of a field."""
    if isinstance(output, dict):
        if "__tuple__" in output:
            return [value_of(each, where) for each in output["__tuple__"]]
        for tag, number in (("__int__", int), ("__float__", float)):
            if tag in output:
                return number(output[tag])
        if "__items__" in output and not output.get("__sampled__"):
            return [value_of(each, where) for each in output["__items__"]]
        if "__repr__" in output or "__dict__" in output:
            raise Unfit(
                f"the output `{where}` is {output.get('__repr__', 'a dict whose keys are no texts')[:80]}, which is too long or of a kind that the server does not tell: have the "
                "machine give numbers, texts, lists and dicts of up to 256 values, or publish it on a topic"
            )
        return {name: value_of(each, f"{where}.{name}") for name, each in output.items()}
    if isinstance(output, list):
        return [value_of(each, where) for each in output]
    return output


def result_of(fields, run, outcome, outputs, words=""):
    """Fields of a result: outputs by name, and facts about the run in the other text fields.

    ``fields`` maps the name of each field to True if it is a text.
    """
    told = {OUTCOME: outcome, RUN: run, **dict.fromkeys(WORDS, words)}
    told = {name: text for name, text in told.items() if fields.get(name) and name not in outputs}
    return {**told, **{name: value_of(value, name) for name, value in outputs.items() if name in fields and value is not None}}


def views(outputs):
    """Names of the outputs of which the server only has a view."""
    return [name for name, value in outputs.items() if not _is_whole(value)]


def _is_whole(value):
    if isinstance(value, dict):
        if "__items__" in value:
            return not value.get("__sampled__") and _is_whole(value["__items__"])
        return "__repr__" not in value and all(map(_is_whole, value.values()))
    return not isinstance(value, list) or all(map(_is_whole, value))


def active_states(snapshot):
    """Innermost active states of a run, each as the names from the root, joined by ``/``."""
    active = (snapshot or {}).get("active", ())
    names = {each["path"]: each["name"] or each["path"].rpartition("/")[2] for each in active}
    parents = {path.rpartition("/")[0] for path in names}
    return [_named(path, names) for path in names if path not in parents]


def _named(path, names):
    parts = path.split("/")
    return "/".join(names.get("/".join(parts[: end + 1]), parts[end]) for end in range(len(parts)))


def feedback_of(fields, run, active):
    """Feedback of an action that a machine declares; None if no field fits.

    ``fields`` maps the name of each text field to True if it is an array.
    """
    told = {name: active if is_array else ", ".join(active) for name, is_array in fields.items() if name in ACTIVE}
    return {**told, **({RUN: run} if fields.get(RUN) is False else {})} if told else None


def complaints(action, goal_fields, result_fields, inputs, outputs):
    """Describe fields of an action's type for which the machine has no port."""
    known = {OUTCOME, RUN, *WORDS}
    said = [f"the goal of {action} has a field `{name}`, and the machine no input of that name" for name in goal_fields if name not in inputs]
    return said + [
        f"the result of {action} has a field `{name}`, and the machine no output of that name"
        for name in result_fields
        if name not in outputs and name not in known
    ]
