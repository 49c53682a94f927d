"""Writes our own conformance machines, one for each rule of the semantics, with the libraries that they use.

``python3 tests/conformance/generate_machines.py`` writes ``machines/`` and ``libraries/`` beside this file; with a folder
as argument it writes there. The name of a machine is the name of its rule.
"""

import os
import sys

from machine_writer import barrier, decider, execution, hierarchy, library, preemptive, write

RULES = {}


def rule(make):
    """Registers a machine by the name of the function that makes it."""
    RULES[make.__name__] = make
    return make


def says(state_id, *names, **interface):
    """A state that logs the inputs it got."""
    told = ", ".join(f"inputs.get({name!r})" for name in names)
    interface.setdefault("inputs", {name: (object, None) for name in names})
    return execution(state_id, f"self.logger.info('%s', repr(({told},)))\nreturn 0", **interface)


def one(child, inputs=None, outputs=None, flows=(), **rest):
    """A root with one child, whose mandatory outcomes are connected to the root's own."""
    ends = [f"{child.state_id}.{name} -> .{name}" for name in child.outcomes]
    outcomes = [name for name in child.outcomes if name not in ("aborted", "preempted")]
    return hierarchy(
        "ROOT", [child], [f"-> {child.state_id}", *ends], flows=flows, inputs=inputs, outputs=outputs, outcomes=outcomes, **rest
    )


# Data


@rule
def newest_value_wins():
    return hierarchy(
        "ROOT",
        [
            execution("EARLY", "outputs['value'] = 'early'\nreturn 0", outputs={"value": (str, None)}),
            execution("LATE", "outputs['value'] = 'late'\nreturn 0", outputs={"value": (str, None)}),
            says("TAKE", "value"),
        ],
        ["-> EARLY", "EARLY.success -> LATE", "LATE.success -> TAKE", "TAKE.success -> .success"],
        flows=["LATE.value -> TAKE.value", "EARLY.value -> TAKE.value", "EARLY.value -> .result"],
        outputs={"result": (str, None)},
    )


@rule
def none_keeps_the_default_of_an_input():
    return hierarchy(
        "ROOT",
        [
            execution("GIVE", "outputs['value'] = None\nreturn 0", outputs={"value": (int, 1)}),
            says("TAKE", "value", inputs={"value": (int, 7)}),
        ],
        ["-> GIVE", "GIVE.success -> TAKE", "TAKE.success -> .success"],
        flows=["GIVE.value -> TAKE.value"],
    )


@rule
def none_overrides_a_scoped_variable():
    return hierarchy(
        "ROOT",
        [
            execution("GIVE", "outputs['value'] = None\nreturn 0", outputs={"value": (int, 1)}),
            says("TAKE", "value", inputs={"value": (int, 7)}),
        ],
        ["-> GIVE", "GIVE.success -> TAKE", "TAKE.success -> .success"],
        flows=["GIVE.value -> $kept", "$kept -> TAKE.value", "$kept -> .result"],
        scoped={"kept": (int, 3)},
        outputs={"result": (int, 9)},
    )


@rule
def none_overrides_the_default_of_a_container_output():
    child = execution("GIVE", "outputs['value'] = None\nreturn 0", outputs={"value": (int, 1)})
    return one(child, outputs={"result": (int, 9)}, flows=["GIVE.value -> .result"])


@rule
def output_default_stays_when_nothing_is_written():
    child = execution("QUIET", "return 0", outputs={"value": (int, 5)})
    outputs = {"result": (int, 9), "untouched": (str, "as declared")}
    return one(child, outputs=outputs, flows=["QUIET.value -> .result"])


@rule
def a_script_changes_only_its_own_copy():
    return hierarchy(
        "ROOT",
        [
            execution("CHANGE", "inputs['items'].append('changed')\nreturn 0", inputs={"items": (list, None)}),
            says("LOOK", "items", inputs={"items": (list, None)}),
        ],
        ["-> CHANGE", "CHANGE.success -> LOOK", "LOOK.success -> .success"],
        flows=["$items -> CHANGE.items", "$items -> LOOK.items"],
        scoped={"items": (list, ["first"])},
    )


@rule
def inputs_reach_scoped_variables_before_the_first_child():
    inner = hierarchy(
        "INNER",
        [says("TAKE", "value")],
        ["-> TAKE", "TAKE.success -> .success"],
        flows=[".given -> $kept", "$kept -> TAKE.value", "$kept -> .result"],
        inputs={"given": (int, 42)},
        outputs={"result": (int, None)},
        scoped={"kept": (int, 0)},
    )
    return one(inner, outputs={"result": (int, None)}, flows=["INNER.result -> .result"])


@rule
def income_may_lead_straight_to_an_outcome():
    inner = hierarchy(
        "INNER",
        [],
        ["-> .success"],
        flows=[".given -> .result"],
        inputs={"given": (str, "through")},
        outputs={"result": (str, None)},
    )
    return one(inner, outputs={"result": (str, None)}, flows=["INNER.result -> .result"])


@rule
def a_counter_loops_through_a_scoped_variable():
    script = """
        outputs['count'] = inputs['count'] + 1
        return 'again' if outputs['count'] < 10 else 'enough'
    """
    child = execution(
        "COUNT", script, inputs={"count": (int, 0)}, outputs={"count": (int, 0)}, outcomes=("again", "enough")
    )
    return hierarchy(
        "ROOT",
        [child],
        ["-> COUNT", "COUNT.again -> COUNT", "COUNT.enough -> .success"],
        flows=["$count -> COUNT.count", "COUNT.count -> $count", "$count -> .result"],
        scoped={"count": (int, 0)},
        outputs={"result": (int, None)},
    )


@rule
def text_defaults_are_read_as_their_type():
    ports = {
        "number": (int, "5"),
        "real": (float, "2.5"),
        "truth": (bool, "1"),
        "items": (list, "[1, 'two']"),
        "table": (dict, "{'a': 1}"),
        "anything": (object, "[3]"),
        "text": (str, "5"),
        "nothing": (str, "None"),
    }
    return one(says("TAKE", *ports, inputs=ports))


@rule
def values_of_every_built_in_type_pass():
    script = """
        outputs.update(number=1, real=0.5, text='é', truth=True, items=[1, [2]], table={'a': {'b': 1}}, pair=(1, 'x'))
        return 0
    """
    kinds = {"number": int, "real": float, "text": str, "truth": bool, "items": list, "table": dict, "pair": tuple}
    ports = {name: (kind, None) for name, kind in kinds.items()}
    child = execution("GIVE", script, outputs=ports)
    return one(child, outputs=ports, flows=[f"GIVE.{name} -> .{name}" for name in ports])


@rule
def an_output_of_the_wrong_type_passes_with_a_complaint():
    return hierarchy(
        "ROOT",
        [
            execution("GIVE", "outputs['value'] = 'no number'\nreturn 0", outputs={"value": (float, 0.0)}),
            says("TAKE", "value", inputs={"value": (float, 0.0)}),
        ],
        ["-> GIVE", "GIVE.success -> TAKE", "TAKE.success -> .success"],
        flows=["GIVE.value -> TAKE.value", "GIVE.value -> .result"],
        outputs={"result": (float, 0.0)},
    )


@rule
def numpy_arrays_pass():
    return hierarchy(
        "ROOT",
        [
            execution("GIVE", "import numpy\noutputs['value'] = numpy.arange(3)\nreturn 0", outputs={"value": (object, None)}),
            execution("SUM", "outputs['sum'] = int(inputs['value'].sum())\nreturn 0",
                      inputs={"value": (object, None)}, outputs={"sum": (int, 0)}),
        ],
        ["-> GIVE", "GIVE.success -> SUM", "SUM.success -> .success"],
        flows=["GIVE.value -> SUM.value", "SUM.sum -> .result"],
        outputs={"result": (int, 0)},
    )


# Outcomes


def _returns(expression):
    return one(execution("LEAF", f"return {expression}", outcomes=("success", "other")))


@rule
def an_outcome_by_id():
    return _returns("1")


@rule
def an_outcome_by_name():
    return _returns("'other'")


@rule
def an_outcome_by_a_value_that_equals_an_id():
    return _returns("True")


@rule
def a_mandatory_outcome_by_name():
    return _returns("'preempted'")


@rule
def no_outcome_is_aborted_without_an_error():
    return _returns("None")


@rule
def an_unknown_name_is_aborted_without_an_error():
    return _returns("'unheard of'")


@rule
def an_unhashable_outcome_is_aborted_with_an_error():
    return _returns("[]")


@rule
def a_script_without_execute_aborts():
    return one(execution("LEAF", "def something_else():\n    pass"))


@rule
def a_script_that_does_not_parse_aborts():
    return one(execution("LEAF", "raw:\ndef execute(self, inputs, outputs, gvm)\n    return 0"))


@rule
def a_root_may_be_a_leaf():
    return execution("ROOT", "outputs['value'] = 'alone'\nreturn 'other'", outcomes=("success", "other"),
                     outputs={"value": (str, None)})


# Errors


FAIL = "raise ValueError('broken')"
TELL_ERROR = "self.logger.info('%r', inputs.get('error'))\nreturn 0"


@rule
def an_error_reaches_the_next_state_only():
    return hierarchy(
        "ROOT",
        [execution("FAIL", FAIL), execution("FIRST", TELL_ERROR), execution("SECOND", TELL_ERROR)],
        ["-> FAIL", "FAIL.aborted -> FIRST", "FIRST.success -> SECOND", "SECOND.success -> .success"],
    )


@rule
def an_unconnected_abort_climbs_with_its_error():
    inner = hierarchy("INNER", [execution("FAIL", FAIL)], ["-> FAIL", "FAIL.success -> .success"])
    middle = hierarchy("MIDDLE", [inner], ["-> INNER", "INNER.success -> .success"])
    return hierarchy("ROOT", [middle], ["-> MIDDLE", "MIDDLE.success -> .success"])


@rule
def an_error_is_caught_one_level_up():
    inner = hierarchy("INNER", [execution("FAIL", FAIL)], ["-> FAIL", "FAIL.success -> .success"])
    return hierarchy(
        "ROOT",
        [inner, execution("CATCH", TELL_ERROR)],
        ["-> INNER", "INNER.success -> .success", "INNER.aborted -> CATCH", "CATCH.success -> .success"],
    )


@rule
def an_error_enters_a_container_through_its_port():
    handler = hierarchy(
        "HANDLER",
        [says("LOOK", "problem")],
        ["-> LOOK", "LOOK.success -> .success"],
        flows=[".error -> LOOK.problem"],
        inputs={"error": (object, None)},
    )
    return hierarchy(
        "ROOT",
        [execution("FAIL", FAIL), handler],
        ["-> FAIL", "FAIL.aborted -> HANDLER", "HANDLER.success -> .success"],
    )


@rule
def a_script_may_name_its_own_error():
    child = execution("FAIL", "outputs['error'] = 'by hand'\nreturn -1", outputs={"other": (int, 0)})
    return hierarchy(
        "ROOT", [child, execution("LOOK", TELL_ERROR)], ["-> FAIL", "FAIL.aborted -> LOOK", "LOOK.success -> .success"]
    )


@rule
def an_abort_without_an_error_hands_none_on():
    child = execution("FAIL", "return -1")
    return hierarchy(
        "ROOT", [child, execution("LOOK", TELL_ERROR)], ["-> FAIL", "FAIL.aborted -> LOOK", "LOOK.success -> .success"]
    )


@rule
def an_unconnected_preempted_climbs():
    inner = hierarchy("INNER", [execution("YIELD", "return -2")], ["-> YIELD", "YIELD.success -> .success"])
    return hierarchy("ROOT", [inner], ["-> INNER", "INNER.success -> .success"])


@rule
def an_unconnected_outcome_waits():
    return hierarchy("ROOT", [execution("LEAF", "return 0")], ["-> LEAF"])


# Concurrency


WAIT = "self.logger.info('preempted: %s', self.preemptive_wait(20))\nreturn 0"
SHORT_WAIT = "self.preemptive_wait(0.2)\nreturn 0"


@rule
def the_first_to_end_preempts_the_others():
    return preemptive(
        "ROOT",
        [execution("FAST", SHORT_WAIT), execution("SLOW", WAIT), execution("SLOWER", WAIT)],
        ["FAST.success -> .first", "SLOW.success -> .second", "SLOWER.success -> .second"],
        outcomes=("first", "second"),
    )


@rule
def the_winners_output_wins():
    winner = execution("FAST", "self.preemptive_wait(0.2)\noutputs['value'] = 'winner'\nreturn 0", outputs={"value": (str, None)})
    loser = execution("SLOW", "self.preemptive_wait(20)\noutputs['value'] = 'loser'\nreturn 0", outputs={"value": (str, None)})
    root = preemptive(
        "RACE",
        [winner, loser],
        ["FAST.success -> .success", "SLOW.success -> .success"],
        flows=["FAST.value -> $value", "SLOW.value -> $value", "$value -> .value"],
        scoped={"value": (str, "none yet")},
        outputs={"value": (str, None)},
    )
    return one(root, outputs={"value": (str, None)}, flows=["RACE.value -> .value"])


@rule
def one_handler_runs_after_preemption():
    tell = "self.logger.info('clean up %s', self.name)\nreturn 0"
    loser = hierarchy(
        "LOSER",
        [execution("WORK", WAIT), execution("CLEAN", tell), execution("MORE", tell)],
        ["-> WORK", "WORK.success -> .success", "WORK.preempted -> CLEAN", "CLEAN.success -> MORE", "MORE.success -> .success"],
    )
    return preemptive(
        "ROOT", [execution("FAST", SHORT_WAIT), loser], ["FAST.success -> .success", "LOSER.success -> .success"]
    )


@rule
def an_error_while_preempted_is_an_abort():
    loser = hierarchy(
        "LOSER",
        [execution("WORK", "self.preemptive_wait(20)\nraise ValueError('late')"), execution("LOOK", TELL_ERROR)],
        ["-> WORK", "WORK.success -> .success", "WORK.aborted -> LOOK", "LOOK.success -> .success"],
    )
    return preemptive(
        "ROOT", [execution("FAST", SHORT_WAIT), loser], ["FAST.success -> .success", "LOSER.success -> .success"]
    )


@rule
def a_winner_that_aborts_takes_its_transition_with_its_error():
    return preemptive(
        "ROOT",
        [execution("FAST", "self.preemptive_wait(0.2)\nraise ValueError('first')"), execution("SLOW", WAIT)],
        ["FAST.aborted -> .failed", "SLOW.success -> .success"],
        outcomes=("success", "failed"),
    )


@rule
def the_decider_sees_outcomes_errors_and_data():
    script = """
        self.logger.info('%s', inputs['value'])
        self.logger.info('%s', self.get_outcome_for_state_name('left').name)
        self.logger.info('%s', self.get_outcome_for_state_id('RIGHT').name)
        self.logger.info('%r', self.get_errors_for_state_name('right'))
        self.logger.info('%r', self.get_errors_for_state_name('left'))
        outputs['value'] = inputs['value'] + 1
        return 'mixed'
    """
    judge = decider(script, inputs={"value": (int, 0)}, outputs={"value": (int, 0)}, outcomes=("success", "mixed"))
    left = execution("LEFT", "outputs['value'] = 41\nreturn 0", outputs={"value": (int, 0)})
    right = execution("RIGHT", FAIL)
    ends = [f"{judge.state_id}.{name} -> .{name}" for name in ("success", "mixed")]
    return barrier(
        "ROOT",
        [left, right, judge],
        [f"LEFT.success -> {judge.state_id}", f"RIGHT.success -> {judge.state_id}", *ends],
        flows=[f"LEFT.value -> {judge.state_id}.value", f"{judge.state_id}.value -> .value"],
        outputs={"value": (int, None)},
        outcomes=("success", "mixed"),
    )


def _barrier_with(judge, transitions, **rest):
    child = execution("LEFT", "return 0")
    return barrier("ROOT", [child, judge], [f"LEFT.success -> {judge.state_id}", *transitions], **rest)


@rule
def a_decider_that_aborts_may_be_connected():
    judge = decider(FAIL)
    return _barrier_with(judge, [f"{judge.state_id}.aborted -> .caught"], outcomes=("success", "caught"))


@rule
def a_decider_that_aborts_unconnected_aborts_the_barrier():
    judge = decider("return -1")
    return _barrier_with(judge, [f"{judge.state_id}.success -> .success"])


@rule
def a_barrier_waits_for_its_slowest_child():
    judge = decider("self.logger.info('all are here')\nreturn 0")
    slow = execution("SLOW", "self.preemptive_wait(0.3)\nself.logger.info('slow')\nreturn 0")
    quick = execution("QUICK", "self.logger.info('quick')\nreturn 0")
    arrivals = [f"{name}.success -> {judge.state_id}" for name in ("SLOW", "QUICK")]
    return barrier("ROOT", [slow, quick, judge], [*arrivals, f"{judge.state_id}.success -> .success"])


@rule
def a_preempted_outcome_may_be_connected():
    return hierarchy(
        "ROOT",
        [execution("YIELD", "return 'preempted'"), execution("NEXT", "self.logger.info('went on')\nreturn 0")],
        ["-> YIELD", "YIELD.preempted -> NEXT", "NEXT.success -> .success"],
    )


@rule
def a_winner_without_a_transition_aborts_the_race():
    return preemptive(
        "ROOT",
        [execution("FAST", "self.preemptive_wait(0.2)\nreturn -1"), execution("SLOW", WAIT)],
        ["SLOW.success -> .success"],
    )


@rule
def preemption_reaches_through_barriers_and_libraries():
    judge = decider("self.logger.info('decided')\nreturn 0")
    waits = [execution(name, WAIT) for name in ("LEFT", "RIGHT")]
    arrivals = [f"{child.state_id}.success -> {judge.state_id}" for child in waits]
    meeting = barrier("MEET", [*waits, judge], [*arrivals, f"{judge.state_id}.success -> .success"])
    patient = library("PATIENT", "own", "patient", patience())
    return preemptive(
        "ROOT",
        [execution("FAST", SHORT_WAIT), meeting, patient],
        ["FAST.success -> .first", "MEET.success -> .second", "PATIENT.success -> .second"],
        outcomes=("first", "second"),
    )


@rule
def concurrent_children_get_their_inputs_at_the_start():
    judge = decider(
        "self.logger.info('%s', inputs['sum'])\nreturn 0", inputs={"sum": (int, 0)}
    )
    add = "outputs['sum'] = inputs['number'] + 1\nreturn 0"
    ports = {"inputs": {"number": (int, 0)}, "outputs": {"sum": (int, 0)}}
    late = execution("LATE", "self.preemptive_wait(0.2)\n" + add, **ports)
    early = execution("EARLY", add, **ports)
    arrivals = [f"{name}.success -> {judge.state_id}" for name in ("LATE", "EARLY")]
    meeting = barrier(
        "MEET",
        [late, early, judge],
        [*arrivals, f"{judge.state_id}.success -> .success"],
        flows=[".given -> $number", "$number -> LATE.number", "$number -> EARLY.number", "LATE.sum -> $number",
               "EARLY.sum -> $number", f"$number -> {judge.state_id}.sum", "$number -> .result"],
        inputs={"given": (int, 10)},
        outputs={"result": (int, None)},
        scoped={"number": (int, 0)},
    )
    return one(meeting, outputs={"result": (int, None)}, flows=["MEET.result -> .result"])


@rule
def the_last_to_arrive_writes_last():
    judge = decider("return 0")
    late = execution("LATE", "self.preemptive_wait(0.2)\noutputs['value'] = 'late'\nreturn 0", outputs={"value": (str, None)})
    early = execution("EARLY", "outputs['value'] = 'early'\nreturn 0", outputs={"value": (str, None)})
    arrivals = [f"{name}.success -> {judge.state_id}" for name in ("LATE", "EARLY")]
    return barrier(
        "ROOT",
        [late, early, judge],
        [*arrivals, f"{judge.state_id}.success -> .success"],
        flows=["LATE.value -> .value", "EARLY.value -> .value"],
        outputs={"value": (str, None)},
    )


# Libraries


def doubler():
    """A library: doubles a number, or tells that it is too big."""
    script = """
        outputs['doubled'] = inputs['number'] * 2
        return 'success' if outputs['doubled'] < 100 else 'too big'
    """
    return execution(
        "DOUBLE", script, inputs={"number": (int, 1)}, outputs={"doubled": (int, 0)}, outcomes=("success", "too big")
    )


def quadrupler():
    """A library made of a library."""
    first = library("FIRST", "own", "doubler", doubler())
    second = library("SECOND", "own", "doubler", doubler())
    return hierarchy(
        "QUADRUPLE",
        [first, second],
        ["-> FIRST", "FIRST.success -> SECOND", "FIRST.too big -> .success", "SECOND.success -> .success", "SECOND.too big -> .success"],
        flows=[".number -> FIRST.number", "FIRST.doubled -> SECOND.number", "SECOND.doubled -> .doubled"],
        inputs={"number": (int, 1)},
        outputs={"doubled": (int, 0)},
    )


def announcer():
    """A library: logs where it stands and what it was given."""
    script = """
        self.logger.info('%s %s', self.get_path(), inputs['text'])
        return 0
    """
    return execution("ANNOUNCE", script, inputs={"text": (str, "nothing to say")})


def patience():
    """A library: waits until it is preempted."""
    inner = execution("INNER", WAIT)
    return hierarchy("PATIENCE", [inner], ["-> INNER", "INNER.success -> .success"])


LIBRARIES = {"doubler": doubler, "quadrupler": quadrupler, "announcer": announcer, "patient": patience}


@rule
def a_library_takes_its_runtime_value():
    child = library("LIB", "own", "doubler", doubler(), inputs={"number": 21})
    return hierarchy(
        "ROOT",
        [child],
        ["-> LIB", "LIB.success -> .success", "LIB.too big -> .big"],
        flows=["LIB.doubled -> .result"],
        outputs={"result": (int, None)},
        outcomes=("success", "big"),
    )


@rule
def a_library_without_runtime_value_takes_its_default():
    child = library("LIB", "own", "announcer", announcer())
    return hierarchy("ROOT", [child], ["-> LIB", "LIB.success -> .success"])


@rule
def a_data_flow_is_stronger_than_a_runtime_value():
    child = library("LIB", "own", "doubler", doubler(), inputs={"number": 21})
    give = execution("GIVE", "outputs['value'] = 50\nreturn 0", outputs={"value": (int, 0)})
    return hierarchy(
        "ROOT",
        [give, child],
        ["-> GIVE", "GIVE.success -> LIB", "LIB.success -> .success", "LIB.too big -> .big"],
        flows=["GIVE.value -> LIB.number", "LIB.doubled -> .result"],
        outputs={"result": (int, None)},
        outcomes=("success", "big"),
    )


@rule
def libraries_nest():
    child = library("LIB", "own", "quadrupler", quadrupler(), inputs={"number": 4})
    return hierarchy(
        "ROOT",
        [child],
        ["-> LIB", "LIB.success -> .success"],
        flows=["LIB.doubled -> .result"],
        outputs={"result": (int, None)},
    )


@rule
def one_library_twice_is_two_states():
    first = library("ONE", "own", "announcer", announcer(), inputs={"text": "first"})
    second = library("TWO", "own", "announcer", announcer(), inputs={"text": "second"})
    return hierarchy("ROOT", [first, second], ["-> ONE", "ONE.success -> TWO", "TWO.success -> .success"])


# Scripts


@rule
def a_default_may_name_a_global_variable():
    return hierarchy(
        "ROOT",
        [
            execution("SET", "gvm.set_variable('speed', 3)\nreturn 0"),
            says("TAKE", "speed", "missing", inputs={"speed": (int, "$speed"), "missing": (object, "$not there")}),
        ],
        ["-> SET", "SET.success -> TAKE", "TAKE.success -> .success"],
    )


@rule
def global_variables_are_copied_unless_by_reference():
    script = """
        copied, shared = [1], [1]
        gvm.set_variable('copied', copied)
        gvm.set_variable('shared', shared, per_reference=True)
        copied.append(2)
        shared.append(2)
        gvm.get_variable('copied').append(3)
        gvm.get_variable('shared').append(3)
        self.logger.info('%s %s', gvm.variable_exist('copied'), gvm.get_variable('none', default='default'))
        return 0
    """
    return one(execution("LEAF", script))


@rule
def a_locked_global_variable_needs_its_key():
    script = """
        gvm.set_variable('guarded', 1)
        key = gvm.lock_variable('guarded')
        gvm.set_locked_variable('guarded', key, 2)
        self.logger.info('%s', gvm.get_locked_variable('guarded', key))
        try:
            gvm.set_variable('guarded', 3, access_key='wrong')
        except RuntimeError as error:
            self.logger.info('%s', type(error).__name__)
        self.logger.info('%s %s', gvm.unlock_variable('guarded', key), gvm.is_locked('guarded'))
        return 0
    """
    return one(execution("LEAF", script))


LOOP_TWICE = ["-> LEAF", "LEAF.again -> LEAF", "LEAF.success -> .success"]


@rule
def the_module_body_runs_at_each_entry():
    script = """
        count = 0

        def execute(self, inputs, outputs, gvm):
            global count
            count += 1
            entries = gvm.get_variable('entries', default=0) + 1
            gvm.set_variable('entries', entries)
            self.logger.info('%d', count)
            return 'again' if entries < 3 else 'success'
    """
    return hierarchy("ROOT", [execution("LEAF", script, outcomes=("success", "again"))], LOOP_TWICE)


@rule
def persistent_variables_survive_between_entries():
    script = """
        entries = self.persistent_variables.get('entries', 0) + 1
        self.persistent_variables['entries'] = entries
        self.logger.info('%d', entries)
        return 'again' if entries < 3 else 'success'
    """
    return hierarchy("ROOT", [execution("LEAF", script, outcomes=("success", "again"))], LOOP_TWICE)


@rule
def a_script_knows_its_place():
    script = """
        self.logger.info('%s %s', self.name, self.state_id)
        self.logger.info('%s %s', self.get_path(), self.get_path(by_name=True))
        self.logger.info('%s %s', self.parent.name, self.is_root_state)
        self.logger.info('%s', sorted(outcome.name for outcome in self.outcomes.values()))
        self.logger.info('%s %s', self.preempted, self.paused)
        self.logger.info('%s', self.get_state_machine().root_state.name)
        self.logger.info('%s', sorted(self.parent.states))
        return 0
    """
    return one(execution("LEAF", script, name="a leaf"))


@rule
def a_script_reads_its_semantic_data():
    script = "self.logger.info('%s', self.semantic_data['place']['room'])\nreturn 0"
    return one(execution("LEAF", script, semantic_data={"place": {"room": "kitchen"}}))


@rule
def what_a_script_prints_is_kept():
    return one(execution("LEAF", "print('one')\nprint('two')\nself.logger.warning('three')\nreturn 0"))


@rule
def a_run_may_start_inside():
    inner = hierarchy(
        "INNER",
        [execution("SKIPPED", FAIL), says("FIRST", "value", inputs={"value": (str, "default")})],
        ["-> SKIPPED", "SKIPPED.success -> FIRST", "FIRST.success -> .success"],
    )
    return hierarchy(
        "ROOT",
        [execution("BEFORE", FAIL), inner],
        ["-> BEFORE", "BEFORE.success -> INNER", "INNER.success -> .success"],
    )


# Machines that change while they run


BUILD = """
from rafcon.core.states.execution_state import ExecutionState
new = ExecutionState("new", "NEW")
head = "def execute(self, inputs, outputs, gvm):"
new.script_text = head + "\\n    self.logger.info('%s %s', self.name, inputs)\\n    return 0\\n"
"""


@rule
def a_state_that_a_script_adds_runs_next():
    add = BUILD + """
ours = self.parent
new.add_input_data_port("word", str, "default")
ours.add_state(new)
ours.transitions[ours.get_transition_for_outcome(self, self.outcomes[0]).transition_id].to_state = "NEW"
ours.add_transition("NEW", 0, "LAST", None)
self.logger.info("%s", sorted(ours.states))
return 0
"""
    return hierarchy(
        "ROOT",
        [execution("ADD", add), says("LAST", "value")],
        ["-> ADD", "ADD.success -> LAST", "LAST.success -> .success"],
    )


@rule
def a_rewired_transition_is_followed():
    rewire = """
ours = self.parent
ours.get_transition_for_outcome(self, self.outcomes[0]).to_state = "OTHER"
return 0
"""
    return hierarchy(
        "ROOT",
        [execution("REWIRE", rewire), execution("SKIPPED", FAIL), says("OTHER", "value")],
        ["-> REWIRE", "REWIRE.success -> SKIPPED", "SKIPPED.success -> .success", "OTHER.success -> .success"],
    )


@rule
def a_removed_state_leaves_its_outcomes_to_others():
    remove = """
ours = self.parent
ours.remove_state("GONE")
ours.add_transition(self.state_id, 0, "LAST", None)
self.logger.info("%s %s", sorted(ours.states), len(ours.transitions))
return 0
"""
    return hierarchy(
        "ROOT",
        [execution("REMOVE", remove), execution("GONE", FAIL), says("LAST", "value")],
        ["-> REMOVE", "REMOVE.success -> GONE", "GONE.success -> LAST", "LAST.success -> .success"],
    )


@rule
def a_new_script_counts_at_the_next_entry():
    change = """
other = self.parent.states["OTHER"]
head = "def execute(self, inputs, outputs, gvm):"
other.script_text = head + "\\n    self.logger.info('changed')\\n    return 0\\n"
return 0
"""
    return hierarchy(
        "ROOT",
        [execution("CHANGE", change), execution("OTHER", FAIL)],
        ["-> CHANGE", "CHANGE.success -> OTHER", "OTHER.success -> .success"],
    )


@rule
def a_data_flow_that_a_script_adds_moves_data():
    connect = """
ours = self.parent
give, take = ours.states["GIVE"], ours.states["TAKE"]
out = give.add_output_data_port("word", str, "given")
port = take.add_input_data_port("word", str, "default")
ours.add_data_flow("GIVE", out, "TAKE", port)
return 0
"""
    return hierarchy(
        "ROOT",
        [execution("CONNECT", connect), execution("GIVE", "return 0"), says("TAKE", "word", inputs={})],
        ["-> CONNECT", "CONNECT.success -> GIVE", "GIVE.success -> TAKE", "TAKE.success -> .success"],
    )


def main():
    here = sys.argv[1] if len(sys.argv) > 1 else os.path.dirname(os.path.abspath(__file__))
    for name, make in RULES.items():
        write(os.path.join(here, "machines", name), make())
    for name, make in LIBRARIES.items():
        write(os.path.join(here, "libraries", name), make())


if __name__ == "__main__":
    main()
