"""JSON and YAML files of state machines as plain dictionaries, and their format of times."""

import json
import time

from rafcon._values import decode

#: Format of times in files.
TIME_STRING_FORMAT = "%Y-%m-%d %H:%M:%S"


def get_current_time_string():
    """Current time in UTC, as text."""
    return time.strftime(TIME_STRING_FORMAT, time.gmtime())


def load_objects_from_json(path, as_dict=False):
    """Content of a JSON file, with tuples, types and objects; with ``as_dict``, unconverted."""
    with open(path, encoding="utf-8") as file:
        text = file.read()
    return json.loads(text) if as_dict else decode(text)


def write_dict_to_json(dictionary, path, **kwargs):
    """Write a dictionary to a JSON file, with tuples, sets and types as in files of machines.

    ``kwargs`` are passed to ``json.dumps``.
    """
    options = {"indent": 4, "sort_keys": True, **kwargs}
    with open(path, "w", encoding="utf-8") as file:
        file.write(json.dumps(_plain(dictionary), **options))


def load_dict_from_yaml(path):
    """Dictionary of a YAML file; needs the package PyYAML."""
    import yaml

    with open(path, encoding="utf-8") as file:
        return yaml.safe_load(file)


def _plain(value):
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_plain(item) for item in value]
    if isinstance(value, (tuple, set)):
        return {"__jsonqualname__": f"__builtin__.{type(value).__name__}", "items": [_plain(item) for item in value]}
    if isinstance(value, type):
        module = "__builtin__" if value.__module__ == "builtins" else value.__module__
        return {"__type__": f"{module}.{value.__qualname__}"}
    return value
