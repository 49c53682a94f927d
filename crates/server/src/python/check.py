"""Says what Python's parser finds in a script, one JSON list on standard output. Nothing of the script runs."""

import json
import sys
import warnings

# More problems than these help nobody.
MOST = 1000


def counted(lines, line, column):
    """A column as JavaScript counts, both from 1 on."""
    if not 1 <= line <= len(lines):
        return 1
    before = lines[line - 1][: max(column - 1, 0)]
    return len(before.encode("utf-16-le", "surrogatepass")) // 2 + 1


def error(lines, fault):
    line = fault.lineno or 1
    found = {"line": line, "column": counted(lines, line, fault.offset or 1), "message": fault.msg, "severity": "error"}
    end_line, end_offset = getattr(fault, "end_lineno", None), getattr(fault, "end_offset", None)
    if end_line and end_offset and end_offset > 0:
        found["end_line"], found["end_column"] = end_line, counted(lines, end_line, end_offset)
    return found


def check(source):
    lines = source.split("\n")
    found = []
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        try:
            compile(source, "script.py", "exec", dont_inherit=True)
        except SyntaxError as fault:
            found.append(error(lines, fault))
        except (ValueError, RecursionError, MemoryError, OverflowError) as fault:
            message = f"{type(fault).__name__}: {fault}".rstrip(": ")
            found.append({"line": 1, "column": 1, "message": message, "severity": "error"})
    for one in warned:
        message = f"{one.category.__name__}: {one.message}"
        found.append({"line": max(one.lineno, 1), "column": 1, "message": message, "severity": "warning"})
    errors_first = sorted(found, key=lambda one: one["severity"])[:MOST]
    return sorted(errors_first, key=lambda one: (one["line"], one["column"]))


json.dump(check(sys.stdin.buffer.read().decode("utf-8", "surrogatepass")), sys.stdout)
