"""Planning again while a machine runs: the other children of a state's container are replaced by the steps of a new plan."""

from rafcon import _ids
from rafcon.planning._plans import NoPlan, Unsolvable, plan

REPLANNED, REACHED, GIVEN_UP = "replanned", "reached", "given up"


def replan(state, inputs, outputs=None):
    """Plans from ``inputs["facts"]`` and puts the new steps in the place of the old ones; returns the outcome of ``state``.

    ``state`` stands in the container whose steps are replaced; it stays, with the states that give it its inputs. Outcomes:
    *replanned*, which then leads to the first step; *reached*, where nothing is left to do; *given up*, where there is no plan,
    none that was not tried before, or ``replans_max`` are over. ``inputs["plans"]`` are the plans so far; with ``outputs``, the
    new one is added to them there.
    """
    plans = [list(tried) for tried in inputs.get("plans") or ()]
    if outputs is not None:
        outputs["plans"] = plans
    # The first plan was no replanning.
    done = max(0, len(plans) - 1)
    if done >= inputs["replans_max"]:
        state.logger.error("it was planned %d times again, as often as allowed (replans_max)", done)
        return GIVEN_UP
    recovery = inputs.get("recovery") or {}
    try:
        found = plan(
            inputs["pool"],
            inputs["facts"],
            inputs["goal"],
            types=inputs.get("types"),
            data=inputs.get("data"),
            engine=inputs.get("engine") or "kairos",
            time_limit=inputs.get("time_limit_s") or 10.0,
            parallel=bool(inputs.get("parallel")),
            retries=recovery.get("retries", 0),
            then=recovery.get("then", "give_up"),
            observe=inputs.get("observe") or None,
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
    _replace(state, found.to_machine().root_state)
    return REPLANNED


def _replace(state, new):
    """Puts the children of a new container in the place of those beside ``state``."""
    container = state.parent
    sources = _sources(container, state)
    for child_id in [child for child in container.states if child != state.state_id and child not in sources]:
        container.remove_state(child_id)
    again, observers = _replanning_of(new)
    ids = {new.state_id: container.state_id}
    if again is not None:
        ids[again.state_id] = state.state_id
        ids.update(zip(sorted(observers), sorted(sources)))
    own = {again.state_id, *observers} if again is not None else set()
    lines = [
        (line.from_state, line.from_outcome, line.to_state, line.to_outcome)
        for line in new.transitions.values()
        if line.from_state not in own
    ]
    for child in [child for child in new.states.values() if child.state_id not in own]:
        old_id = child.state_id
        # Never an id of an earlier plan: whoever follows the run knows those by their old names.
        child.change_state_id(_ids.state_id({container.state_id, *container.states, *new.states}))
        ids[old_id] = container.add_state(child)
    replanned = next(key for key, outcome in state.outcomes.items() if outcome.name == REPLANNED)
    for from_state, from_outcome, to_state, to_outcome in lines:
        # What begins the new container begins where it was planned; where the old one begins is the same.
        begins = from_state is None
        origin = (state.state_id, replanned) if begins else (ids[from_state], from_outcome)
        container.add_transition(*origin, ids[to_state], to_outcome)
        if begins:
            container.set_start_state(ids[to_state])


def _sources(container, state):
    """The siblings whose outputs are inputs of ``state``."""
    flows = container.data_flows.values()
    return {flow.from_state for flow in flows if flow.to_state == state.state_id and flow.from_state != container.state_id}


def _replanning_of(new):
    """The state of a new container that plans again, and those that it hears."""
    for child in new.states.values():
        if any(port.name == "replans_max" for port in child.input_data_ports.values()):
            return child, _sources(new, child)
    return None, set()
