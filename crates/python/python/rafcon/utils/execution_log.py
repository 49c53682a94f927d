"""Logs of runs as tables, from ``shelve`` files of the reference or of this package.

``execution_history_items`` is such a file, opened with ``shelve.open(name)``. It maps the id of an
entry to its content, a dictionary. Its values are pickles: reading them runs code of their classes,
so read only logs that you trust. ``StateMachine.get_last_execution_log_filename`` returns the name
of the file of a program's last run.
"""

import pickle

from rafcon.utils.log import get_logger

logger = get_logger(__name__)

_PER_ITEM = ("timestamp", "history_item_id", "prev_history_item_id", "item_type", "call_type")
_VALUES = ("input_output_data", "scoped_data", "semantic_data")
_CONCURRENT = ("BarrierConcurrencyState", "PreemptiveConcurrencyState")


def log_to_raw_structure(execution_history_items):
    """Return (start, previous, next, concurrent, grouped): the first entry, and relations of ids.

    ``concurrent`` maps an id to a list with the first entry of each branch. ``grouped`` maps the id
    of a state's run to its entries.
    """
    start, previous, following, concurrent, grouped = None, {}, {}, {}, {}
    for item in _ordered(execution_history_items):
        key, before = item["history_item_id"], item["prev_history_item_id"]
        grouped.setdefault(item["run_id"], []).append(item)
        if item["item_type"] == "StateMachineStartItem":
            start = item
        if before is None:
            continue
        previous[key] = before
        if before in execution_history_items and execution_history_items[before]["item_type"] == "ConcurrencyItem":
            if item["item_type"] != "ReturnItem":
                concurrent.setdefault(before, []).append(key)
                continue
        following[before] = key
    return start, previous, following, concurrent, grouped


def log_to_collapsed_structure(
    execution_history_items, throw_on_pickle_error=True, include_erroneous_data_ports=False, full_next=False
):
    """Return (start, next, concurrent, hierarchy, items), with one entry for each run of a state.

    An entry contains the call and the return. ``items`` maps the id of a run to its entry. The
    other dictionaries relate these ids: ``next`` to the following run in the container,
    ``concurrent`` to the branches, ``hierarchy`` to the first run inside. ``full_next`` also
    relates a run that ends its container to the successor of the container. A value that cannot be
    read raises an error, or is skipped if ``throw_on_pickle_error`` is False.
    """
    values = _Values(throw_on_pickle_error, include_erroneous_data_ports)
    start, _previous, _following, _concurrent, grouped = log_to_raw_structure(execution_history_items)
    items = {run: _collapsed(entries, values) for run, entries in grouped.items()}
    relations = _Relations()
    for item in _ordered(execution_history_items):
        relations.add(item)
    if full_next:
        relations.lead_out()
    found = None if start is None else items[start["run_id"]]
    return found, relations.next, relations.concurrent, relations.hierarchy, items


def log_to_DataFrame(
    execution_history_items,
    data_in_columns=(),
    data_out_columns=(),
    scoped_in_columns=(),
    scoped_out_columns=(),
    semantic_data_columns=(),
    throw_on_pickle_error=True,
):
    """Table of runs: a ``pandas.DataFrame`` with a row per run, ordered by call; needs pandas.

    The arguments ``…_columns`` name ports and keys. Each is a column ``data_ins__name`` and so on.
    """
    import pandas

    *_relations, items = log_to_collapsed_structure(execution_history_items, throw_on_pickle_error)
    wanted = {
        "data_ins": data_in_columns,
        "data_outs": data_out_columns,
        "scoped_data_ins": scoped_in_columns,
        "scoped_data_outs": scoped_out_columns,
        "semantic_data": semantic_data_columns,
    }
    rows = [_row(item, wanted) for item in items.values() if "timestamp_call" in item]
    table = pandas.DataFrame(rows)
    for column in ("timestamp_call", "timestamp_return"):
        table[column] = pandas.to_datetime(table[column], unit="s")
    return table.set_index(table["timestamp_call"])


def _row(item, wanted):
    row = {name: value for name, value in sorted(item.items()) if not isinstance(value, dict)}
    row.setdefault("timestamp_return", None)
    for group, names in wanted.items():
        row.update({f"{group}__{name}": item.get(group, {}).get(name) for name in names})
    return row


def _ordered(items):
    return sorted((items[key] for key in items), key=lambda item: (item["timestamp"], item["history_item_id"]))


class _Values:
    """Reader of pickled values."""

    def __init__(self, is_strict, keeps_errors):
        self._is_strict = is_strict
        self._keeps_errors = keeps_errors

    def read(self, pickled):
        """Read values by name. A prefix ``!`` of a name marks a value that could not be pickled."""
        found = {}
        for name, value in pickled.items():
            if name.startswith("!"):
                if self._keeps_errors:
                    found[name] = value
                continue
            try:
                found[name] = pickle.loads(value) if isinstance(value, bytes) else value
            except Exception:
                if self._is_strict:
                    raise
                logger.exception("the value of '%s' cannot be read", name)
        return found


def _collapsed(entries, values):
    first = entries[0]
    item = {name: value for name, value in first.items() if name not in _PER_ITEM and name not in _VALUES}
    item["semantic_data"] = values.read(first.get("semantic_data", {}))
    if first["item_type"] != "CallItem":
        item["timestamp"] = first["timestamp"]
        return item
    item.update(timestamp_call=first["timestamp"], timestamp_return=None, outcome_name=None, outcome_id=None)
    item.update(data_ins=values.read(first["input_output_data"]), scoped_data_ins=values.read(first["scoped_data"]))
    item.update(data_outs={}, scoped_data_outs={})
    last = entries[-1]
    if last["item_type"] == "ReturnItem":
        item.update(timestamp_return=last["timestamp"])
        item.update({name: last[name] for name in ("outcome_name", "outcome_id")})
        item.update(data_outs=values.read(last["input_output_data"]), scoped_data_outs=values.read(last["scoped_data"]))
    return item


class _Relations:
    """Relations between the runs of states, collected in one pass through the log."""

    def __init__(self):
        self.next, self.concurrent, self.hierarchy = {}, {}, {}
        # Active runs of states: path to (run, flag for parallel children). Run to its last child run.
        self._open, self._last, self._parents = {}, {}, {}
        self._seen = set()

    def add(self, item):
        """Process the next entry."""
        run, path = item["run_id"], item["path"]
        if item["item_type"] == "StateMachineStartItem":
            self._last[None] = run
        elif item["item_type"] == "CallItem" and run not in self._seen:
            self._begin(run, path, item["state_type"] in _CONCURRENT)

    def _begin(self, run, path, is_concurrent):
        self._seen.add(run)
        parent, side_by_side = self._open.get(path.rpartition("/")[0], (None, False))
        self._parents[run] = parent
        if side_by_side:
            self.concurrent.setdefault(parent, []).append(run)
        elif parent in self._last:
            self.next[self._last[parent]] = run
        elif parent is not None:
            self.hierarchy[parent] = run
        self._last[parent] = run
        self._open[path] = run, is_concurrent

    def lead_out(self):
        """Relate the last run of a container to the successor of the container."""
        for parent, last in self._last.items():
            above = parent
            while above is not None and above not in self.next:
                above = self._parents.get(above)
            if above is not None and parent not in self.concurrent:
                self.next[last] = self.next[above]
