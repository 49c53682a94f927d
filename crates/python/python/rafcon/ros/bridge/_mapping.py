"""What a goal is for a run, and what a run is for its goal. Knows messages and values; asks nobody."""

import array
import math
from collections.abc import Mapping

#: Names of result fields for the outcome, the run and a text, unless the machine has an output with that name.
OUTCOME, RUN, WORDS = "outcome", "run", ("message", "error_msg")
#: Names of feedback fields for the active states.
ACTIVE = ("active", "active_states")


class Unfit(Exception):
    """A value does not fit; the text says which, and the way out."""


def plain(value, where="the goal"):
    """A field of a message as a value of JSON."""
    if isinstance(value, Mapping):
        return {name: plain(each, f"{where}.{name}") for name, each in value.items()}
    if isinstance(value, (list, tuple, bytes, array.array)):
        return [plain(each, where) for each in value]
    if isinstance(value, float) and not math.isfinite(value):
        raise Unfit(f"{where} is {value}, which cannot be an input of a run: send a finite number")
    return value


def inputs_of(goal, ports):
    """The inputs of a run by the names of its ports, from the goal of an action that a machine declares."""
    return {name: plain(goal[name], name) for name in goal if name in ports}


def value_of(output, where):
    """An output of a run, as the server tells it, as a value for a field."""
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
    """The fields of a result: outputs by name, and what is known of the run for the others. ``fields`` says of each whether it is a text."""
    told = {OUTCOME: outcome, RUN: run, **dict.fromkeys(WORDS, words)}
    told = {name: text for name, text in told.items() if fields.get(name) and name not in outputs}
    return {**told, **{name: value_of(value, name) for name, value in outputs.items() if name in fields and value is not None}}


def views(outputs):
    """The names of outputs of which the server has a view only."""
    return [name for name, value in outputs.items() if not _is_whole(value)]


def _is_whole(value):
    if isinstance(value, dict):
        if "__items__" in value:
            return not value.get("__sampled__") and _is_whole(value["__items__"])
        return "__repr__" not in value and all(map(_is_whole, value.values()))
    return not isinstance(value, list) or all(map(_is_whole, value))


def active_states(snapshot):
    """The innermost active states of a run, each as the names from the root on, joined by ``/``."""
    active = (snapshot or {}).get("active", ())
    names = {each["path"]: each["name"] or each["path"].rpartition("/")[2] for each in active}
    parents = {path.rpartition("/")[0] for path in names}
    return [_named(path, names) for path in names if path not in parents]


def _named(path, names):
    parts = path.split("/")
    return "/".join(names.get("/".join(parts[: end + 1]), parts[end]) for end in range(len(parts)))


def feedback_of(fields, run, active):
    """The feedback of an action that a machine declares; ``fields`` says of its texts whether they are arrays. Nothing if none fits."""
    told = {name: active if is_array else ", ".join(active) for name, is_array in fields.items() if name in ACTIVE}
    return {**told, **({RUN: run} if fields.get(RUN) is False else {})} if told else None


def complaints(action, goal_fields, result_fields, inputs, outputs):
    """What of the type of an action the machine does not have, in words."""
    known = {OUTCOME, RUN, *WORDS}
    said = [f"the goal of {action} has a field `{name}`, and the machine no input of that name" for name in goal_fields if name not in inputs]
    return said + [
        f"the result of {action} has a field `{name}`, and the machine no output of that name"
        for name in result_fields
        if name not in outputs and name not in known
    ]
