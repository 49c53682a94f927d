"""Replanning in a running machine: the steps of a new plan replace a state's siblings."""

import functools

from rafcon import _ids
from rafcon._bridge import native
from rafcon.core.custom_exceptions import StatePreempted
from rafcon.core.states.container_state import ContainerState
from rafcon.core.states.library_state import LibraryState
from rafcon.planning._plans import NoPlan, Unsolvable, plan

#: Interval of polling (s).
_LISTEN_S = 0.005

#: Layout of states without a planned position: margin, height of their container's name, and size.
_MARGIN, _HEADING, _STATE = 50.0, 60.0, (120.0, 72.0)

REPLANNED, REACHED, GIVEN_UP = "replanned", "reached", "given up"


def replan(state, inputs, outputs=None):
    """Plan from ``inputs["facts"]`` and replace the old steps by new ones; return an outcome name.

    ``state`` is in the container whose steps are replaced, or it is the root of a library in that
    container, such as ``planning/replan``. It stays, and so do the states that provide its inputs.
    The outcomes are *replanned*, which then leads to the first step; *reached* if no steps are
    left; and *given up* if there is no plan, no untried plan, or ``replans_max`` is reached.
    ``inputs["plans"]`` are the plans so far; with ``outputs``, the new one is added to them there.
    Failed steps of the new plan lead to the state that provides ``facts``. ``inputs["observe"]``
    names the library of that state if it is no library state.
    """
    host = state.parent if isinstance(state.parent, LibraryState) else state
    if host is not state:
        _must_remember(host)
    plans = [list(tried) for tried in inputs.get("plans") or ()]
    if outputs is not None:
        outputs["plans"] = plans
    # The first plan does not count as replanning.
    done = max(0, len(plans) - 1)
    if plans and done >= inputs["replans_max"]:
        state.logger.error("it was planned %d times again, as often as allowed (replans_max)", done)
        return GIVEN_UP
    recovery = inputs.get("recovery") or {}
    try:
        found = plan(
            inputs["pool"],
            inputs["facts"],
            inputs["goal"] or None,
            types=inputs.get("types"),
            data=inputs.get("data"),
            engine=inputs.get("engine") or "kairos",
            time_limit=inputs.get("time_limit_s") or 10.0,
            parallel=bool(inputs.get("parallel")),
            retries=recovery.get("retries", 0),
            then=recovery.get("then", "give_up"),
            observe=inputs.get("observe") or _library_of(_source(host, "facts")),
            state=state,
        )
    except (NoPlan, Unsolvable) as error:
        state.logger.error("no other plan: %s", error)
        return GIVEN_UP
    if not found.steps:
        return REACHED
    steps = [str(step) for step in found.steps]
    if steps in plans:
        state.logger.error("this plan has failed before: %s", ", ".join(steps))
        return GIVEN_UP
    plans.append(steps)
    state.logger.info("a new plan: %s", ", ".join(steps))
    _replace(host, found.to_machine().root_state)
    # The new steps may run only when a restarted runner would know them.
    while not native.has_kept_changes():
        if state.preemptive_wait(_LISTEN_S):
            raise StatePreempted()
    return REPLANNED


def _must_remember(host):
    """Raise ``ValueError`` unless the tried plans are stored in a scoped variable around ``host``.

    A library state has no memory of its own, and would try one plan forever.
    """
    memory = host.parent
    key = next(key for key, port in host.input_data_ports.items() if port.name == "plans")
    told = next(key for key, port in host.output_data_ports.items() if port.name == "plans")
    ends = {(flow.from_state, flow.from_key, flow.to_state, flow.to_key) for flow in memory.data_flows.values()}
    own, here = memory.state_id, host.state_id
    if not any({(own, each, here, key), (here, told, own, each)} <= ends for each in memory.scoped_variables):
        raise ValueError(
            "nothing remembers the plans that were tried: connect `plans` with a scoped variable of "
            f"`{memory.name}`, in both directions"
        )


def _replace(host, new):
    """Replace the siblings of ``host`` by the children of a new container, in one change."""
    container = host.parent
    kept = {host.state_id, *_sources(container, host)}
    removed = [child for child in container.states if child not in kept]
    changes = [("children.remove", (child,)) for child in removed]
    ids, own = _taken_over(host, new)
    lines = [
        (line.from_state, line.from_outcome, line.to_state, line.to_outcome)
        for line in new.transitions.values()
        if line.from_state not in own
    ]
    # Never reuse an id of an earlier plan: viewers of the run know those by their old names.
    used = {container.state_id, *container.states, *new.states}
    for child in [child for child in new.states.values() if child.state_id not in own]:
        old_id = child.state_id
        child._take_over()
        child.change_state_id(_ids.state_id(used))
        child._store_notes()
        used.add(child.state_id)
        ids[old_id] = child.state_id
        changes.append(("children.add", (child._home.document,)))
    replanned = next(key for key, outcome in host.outcomes.items() if outcome.name == REPLANNED)
    for key, line in container.transitions.items():
        if (line.from_state, line.from_outcome) == (host.state_id, replanned) and line.to_state not in removed:
            changes.append(("transition.remove", (key,)))
    changes += _lines(container, [_moved(line, ids, (host.state_id, replanned)) for line in lines])
    changes += _places(container, kept, new, ids)
    begins = next((ids[to_state] for from_state, _, to_state, _ in lines if from_state is None), None)
    if container.start_state_id in (None, *removed):
        changes += _lines(container, [(None, None, begins, None)])
    container._home.change(container, changes)


def _places(container, kept, new, ids):
    """Layout changes for the container.

    Steps are placed as in ``new``, and states missing there in a row above.
    """
    places = {ids[child.state_id]: child._home.layout(child) for child in new.states.values()}
    others = [child for child in container.states if child in kept and child not in places]
    left, top, width, height = _MARGIN, _HEADING, *_STATE
    changes = []
    for child in others:
        changes.append(("layout.child", (child, left, top, width, height)))
        left += width + _MARGIN
    below = height + _MARGIN if others else 0.0
    changes += [("layout.child", (child, x, y + below, *size)) for child, (x, y, *size) in places.items()]
    _, _, width, height = new._home.layout(new)
    changes.append(_room(container, max(width, left), height + below))
    return changes


def _room(container, width, height):
    """Return the change that enlarges a container; containers around it are enlarged at once."""
    left, top, *size = container._home.layout(container) or (0.0, 0.0, 0.0, 0.0)
    width, height = max(width, size[0]), max(height, size[1])
    around = container.parent
    if isinstance(around, ContainerState) and [width, height] != size:
        around._home.change(around, [_room(around, left + width + _MARGIN, top + height + _MARGIN)])
    return "layout.size", (width, height)


def _taken_over(host, new):
    """Map ids of ``new`` to existing ids, for its container and the states that already exist.

    Also returns the ids in ``new`` of the states that already exist.
    """
    ids, own = {new.state_id: host.parent.state_id}, set()
    again = _replanning_of(new)
    if again is not None:
        observer = _source(again, "facts")
        own = {again.state_id, observer.state_id}
        ids.update({again.state_id: host.state_id, observer.state_id: (_source(host, "facts") or host).state_id})
    return ids, own


def _moved(line, ids, beginning):
    """Translate a transition by ``ids``; the start transition begins at ``beginning``."""
    from_state, from_outcome, to_state, to_outcome = line
    origin = beginning if from_state is None else (ids[from_state], from_outcome)
    return (*origin, ids[to_state], to_outcome)


def _lines(container, lines):
    """Changes that add transitions."""
    is_taken = functools.partial(container._home.has_line, container, "transitions")
    return [("transition.add", (_ids.transition_id(is_taken), *line)) for line in lines]


def _sources(container, state):
    """Ids of the siblings whose outputs are inputs of ``state``."""
    flows = container.data_flows.values()
    return {flow.from_state for flow in flows if flow.to_state == state.state_id and flow.from_state != container.state_id}


def _source(state, name):
    """Sibling that provides this input of ``state``, or None."""
    container = state.parent
    keys = {key for key, port in state.input_data_ports.items() if port.name == name}
    flows = container.data_flows.values()
    found = (flow.from_state for flow in flows if flow.to_state == state.state_id and flow.to_key in keys)
    return next((container.states[sibling] for sibling in found if sibling in container.states), None)


def _library_of(state):
    """Path and name of a library state, joined by ``/``; None for any other state or None."""
    return f"{state.library_path}/{state.library_name}" if isinstance(state, LibraryState) else None


def _replanning_of(new):
    """State of a new container that replans, or None."""
    for child in new.states.values():
        if isinstance(child, LibraryState) and _source(child, "facts") is not None:
            if any(port.name == "replans_max" for port in child.input_data_ports.values()):
                return child
    return None
