"""Programs that build machines with ``rafcon.core…`` classes, save, load and run them."""

import tempfile
import textwrap
import unittest

import building
from building import REFERENCE, call
from support import ROOT

#: Builds one machine with everything, and saves it to the folder in ``OUT``.
EVERYTHING = """
root = HierarchyState("root *1*", state_id="ROOTID")
root.add_input_data_port("speed", float, 0.5)
root.add_output_data_port("report", "dict", {"a": [1, 2.5, None], "b": (True, "x")})
count = root.add_scoped_variable("count", int, "3")
root.description = "A machine with everything\\nin it: \\u00e4"
first = ExecutionState("first", state_id="FIRSTX")
first.script_text = "def execute(self, inputs, outputs, gvm):\\n    return 'again'\\n"
first.add_outcome("again", 4)
first.add_input_data_port("speed", "float", 1.0)
first.add_output_data_port("count", int)
first.semantic_data["tool"]["gripper"] = "open"
second = PreemptiveConcurrencyState("second", state_id="SECOND")
for name in ("ONEXXX", "TWOXXX"):
    state = ExecutionState(name.lower(), state_id=name)
    second.add_state(state)
    second.add_transition(name, 0, "SECOND", 0)
third = BarrierConcurrencyState("third", state_id="THIRDX")
for state in (first, second, third):
    root.add_state(state)
for name in ("FOURXX", "FIVEXX"):
    state = ExecutionState(name.lower(), state_id=name)
    third.add_state(state)
decider = third.states["unique_decider_state_id"]
third.add_transition(decider.state_id, 0, "THIRDX", 0)
root.set_start_state(first)
root.add_transition("FIRSTX", 0, "SECOND", None)
root.add_transition("FIRSTX", 4, "FIRSTX", None)
root.add_transition("SECOND", 0, "THIRDX", None)
root.add_transition("THIRDX", 0, "ROOTID", 0)
root.add_data_flow("ROOTID", 0, "FIRSTX", 0)
root.add_data_flow("FIRSTX", 1, "ROOTID", count)
machine = StateMachine(root, version="1.0")
storage.save_state_machine_to_path(machine, os.environ["OUT"])
"""

#: Changes machines in every way that needs no desktop, and tells what is left; the ids that are made by chance are not shown.
CHANGES = """
def tell(state):
    ids = {key: key if len(key) < 3 else "new" for key in state.states}
    ids[state.state_id] = "own"
    print(sorted(ids[key] for key in state.states))
    lines = state.transitions.values()
    show = lambda line: (ids.get(line.from_state), line.from_outcome, ids[line.to_state], line.to_outcome)
    print(sorted(map(show, lines), key=str))

root = HierarchyState("root")
a, b, c, d = states = [ExecutionState(name, state_id=name) for name in "ABCD"]
for state in states:
    print(root.add_state(state) == state.state_id)
print(len(root.add_state(ExecutionState("again", state_id="A"))))
root.set_start_state(a)
for one, other in zip(states, states[1:]):
    root.add_transition(one.state_id, 0, other.state_id, None)
root.add_transition("D", 0, root.state_id, 0)
tell(root)
group = root.group_states(["B", "C"])
tell(root)
tell(group)
print(b.parent is group, sorted(group.outcomes), group.name)
root.ungroup_state(group.state_id)
tell(root)
print(b.parent is root)
new = ExecutionState("new", state_id="N")
print(root.substitute_state("B", new) is new, b.parent, new.parent is root)
tell(root)
print(root.remove_state("N") is new, len(root.states), "N" in root.states)
tell(root)
root.remove(c)
print(len(root.transitions), root.start_state_id)
root.set_start_state(None)
print(root.start_state_id, a in root)
"""

#: What is refused, by the name of the exception.
REFUSALS = """
root = HierarchyState("root", state_id="R")
e = ExecutionState("e", state_id="E")
root.add_state(e)
refused(e.add_outcome, "success")
refused(e.remove_outcome, -1)
refused(e.remove_outcome, 77)
refused(e.add_input_data_port, "k", int, "x")
refused(e.add_input_data_port, "l", float, 3)
refused(e.add_input_data_port, "m", "foo.bar")
e.add_input_data_port("i", int, 3)
refused(e.add_input_data_port, "i", int)
refused(e.remove_input_data_port, 99)
refused(root.set_start_state, "NOPE")
refused(root.add_transition, "E", 0, "R", 0)
refused(root.add_transition, "E", 0, "R", 0)
refused(root.add_transition, "E", 5, "R", 0)
refused(root.add_transition, "Q", 0, "R", 0)
refused(root.add_transition, "E", -1, "R", None)
refused(root.add_transition, "E", "x", "R", 0)
refused(root.remove_transition, 55)
root.add_scoped_variable("v", float, 1.0)
refused(root.add_scoped_variable, "v", float, 1.0)
refused(root.add_scoped_variable, "w", int, "x")
refused(root.add_data_flow, "R", 0, "E", 0)
refused(root.add_data_flow, "R", 0, "E", 55)
refused(root.remove_data_flow, 99)
refused(setattr, e, "name", "")
refused(setattr, e, "name", "a/b")
refused(setattr, e, "state_id", "Z")
refused(setattr, e, "description", 3)
refused(setattr, e.outcomes[0], "name", "aborted")
refused(setattr, e.outcomes[0], "name", "")
refused(setattr, e.outcomes[0], "outcome_id", 5)
refused(setattr, e.input_data_ports[0], "name", "")
refused(root.remove_state, "NOPE")
barrier = BarrierConcurrencyState("barrier", state_id="B")
x = ExecutionState("x", state_id="X")
barrier.add_state(x)
refused(barrier.remove_state, "unique_decider_state_id")
refused(barrier.set_start_state, "X")
refused(StateMachine, 3)
refused(setattr, e, "name", 3)
refused(setattr, e, "script_text", 3)
refused(storage.save_state_machine_to_path, StateMachine(HierarchyState("new")), None)
refused(e.preemptive_wait, "1")
refused(storage.load_state_machine_from_path, "/nowhere")
refused(state_machine_manager.add_state_machine, 3)
print(len(e.outcomes), len(e.input_data_ports), len(root.transitions), len(root.data_flows), len(barrier.transitions))
"""


#: Gives ports with defaults other types.
TYPES = """
for value, types in (
    (12, "int float object"), (12.5, "float int object"), (True, "bool int object"), ("x", "str object"), (0, "float"),
    ([1, 2], "list object"), ((1, 2), "tuple object"), ({"a": 1}, "dict object"),
):
    for new in types.split():
        state = HierarchyState("s")
        input = state.input_data_ports[state.add_input_data_port("a", type(value), value)]
        output = state.output_data_ports[state.add_output_data_port("b", type(value), value)]
        variable = state.scoped_variables[state.add_scoped_variable("c", type(value), value)]
        if (value, new) != (12.5, "int"):
            input.data_type = new
        output.change_data_type(new)
        print(new, repr(output.default_value))
        if (value, new) != (12.5, "int"):
            variable.data_type = new
            print(input.default_value == value, variable.default_value == value)
"""

#: Keeps collections of a state, and changes it.
COLLECTIONS = """
state = HierarchyState("s", state_id="S")
child = ExecutionState("c", state_id="C")
found = state.outcomes, state.input_data_ports, state.output_data_ports, state.scoped_variables
found += state.states, state.transitions, state.data_flows
tell = lambda: print([len(group) for group in found])
tell()
state.add_outcome("n")
first = state.add_input_data_port("a", int)
state.add_output_data_port("b", int)
state.add_scoped_variable("c", int)
state.add_state(child)
inner = child.add_input_data_port("i", int)
line = state.add_transition("C", 0, "S", 0)
state.add_data_flow("S", first, "C", inner)
tell()
print(found[0] is state.outcomes, found[1] == state.input_data_ports, line in found[5], list(found[1]) == [first])
print(isinstance(found[0], dict), sorted(dict(found[0])), sorted({**found[0]}), [o.name for o in found[0].values()])
state.remove_state("C")
tell()
"""


class Building(unittest.TestCase):
    def check(self, program, expected, **environment):
        self.assertEqual(call(program, **environment), textwrap.dedent(expected).lstrip("\n"))

    def test_a_new_state_has_what_every_state_has(self):
        self.check(
            """
            state = ExecutionState()
            print(state.name, len(state.state_id), state.parent, {key: o.name for key, o in state.outcomes.items()})
            print(state.script_text.strip())
            print(HierarchyState().name, ExecutionState(7).name)
            """,
            """
            ExecutionState 1 6 None {-2: 'preempted', -1: 'aborted', 0: 'success'}
            def execute(self, inputs, outputs, gvm):
                self.logger.info("Hello {}".format(self.name))
                self.preemptive_wait(2)
                return "success"
            HierarchyState 2 7
            """,
        )

    def test_elements_show_what_the_state_has_now(self):
        self.check(
            """
            state = HierarchyState("s", input_data_ports=[InputDataPort("a", int, "5", 0)], outcomes={3: Outcome(3, "ok")})
            port, outcome = state.input_data_ports[0], state.outcomes[3]
            print(port.default_value, port.parent is state, port in state, sorted(state.outcomes))
            port.name, port.default_value, outcome.name = "b", 6, "fine"
            print(state.input_data_ports[0].name, state.outcomes[3].name, port, state.outcomes[3] is outcome)
            port.data_type = str
            print(port.data_type.__name__, port.default_value)
            port.change_data_type(float, "2.5")
            print(port.default_value)
            state.remove(port)
            print(port.parent, port.name, len(state.input_data_ports))
            """,
            """
            5 True True [-2, -1, 3]
            b fine DataPort 'b' [0] (6 <class 'int'>) True
            str 6
            2.5
            None b 0
            """,
        )

    def test_a_container_may_be_built_at_once(self):
        self.check(
            """
            inner = {"Q": ExecutionState("q", state_id="Q")}
            lines = {7: Transition("Q", 0, "H", 0, 7)}
            state = HierarchyState("h", "H", states=inner, transitions=lines, start_state_id="Q",
                                   scoped_variables=[ScopedVariable("v", int, 1, 0)])
            print(list(state.states), state.states["Q"] is inner["Q"], sorted(state.transitions), state.start_state_id)
            print(state.transitions[7] is lines[7], state.scoped_variables[0].default_value)
            lines[7].from_outcome = -1
            print(state.transitions[7])
            """,
            """
            ['Q'] True [1, 7] Q
            True 1
            Transition - from_state: Q, from_outcome: -1, to_state: H, to_outcome: 0, id: 7
            """,
        )

    def test_a_script_may_be_made_and_given_to_a_state(self):
        self.check(
            """
            from rafcon.core.script import Script
            out = os.environ["OUT"]
            with open(out + "/mine.py", "w") as file:
                file.write("def execute(self, inputs, outputs, gvm):\\n    return 0\\n")
            state = ExecutionState("s")
            print(Script().script == state.script_text)
            made = Script(out, "mine.py", state)
            print(made.path == out, made.filename, made.parent is state, "return 0" in state.script_text)
            state.script = made
            print(state.script is made, state.script_text == made.script, made.filename)
            made.script = "# new"
            print(state.script_text)
            refused(setattr, state, "script", "text")
            refused(Script, out, "missing.py")
            """,
            """
            True
            True mine.py True False
            True True script.py
            # new
            TypeError
            FileNotFoundError
            """,
        )

    def test_a_state_of_another_kind_keeps_what_it_can(self):
        self.check(
            """
            root = HierarchyState("root", "R")
            inner = HierarchyState("inner", "I")
            leaf = ExecutionState("leaf", "L")
            inner.add_state(leaf)
            root.add_state(inner)
            changed = root.change_state_type(inner, PreemptiveConcurrencyState)
            print(type(changed).__name__, changed.name, changed.states["L"] is leaf, leaf.get_path(), inner.parent)
            machine = StateMachine(root)
            print(type(machine.change_root_state_type(BarrierConcurrencyState)).__name__, leaf.get_path(by_name=True))
            """,
            """
            PreemptiveConcurrencyState inner True R/I/L None
            BarrierConcurrencyState root/inner/leaf
            """,
        )

    def test_a_default_stays_with_another_type(self):
        self.check(
            """
            port = lambda value: (state := ExecutionState()).input_data_ports[state.add_input_data_port("a", type(value), value)]
            changed = port(12.5)
            changed.change_data_type(int)
            print(repr(changed.default_value), changed.data_type)
            for new in ("float", "str", "float", "object", "float"):
                changed.data_type = new
                print(repr(changed.default_value), changed.data_type)
            changed.change_data_type(bool)
            print(changed.default_value)
            several = port([1, 2])
            several.data_type = tuple
            print(several.default_value)
            changed.change_data_type(list, [1])
            print(changed.default_value)
            endless = port(float("inf"))
            endless.change_data_type(int)
            print(endless.default_value)
            """,
            """
            12 <class 'int'>
            12.0 <class 'float'>
            '12.0' <class 'str'>
            12.0 <class 'float'>
            12.0 <class 'object'>
            12.0 <class 'float'>
            None
            (1, 2)
            [1]
            None
            """,
        )

    def test_collections_of_a_state_are_live(self):
        self.check(
            COLLECTIONS
            + textwrap.dedent("""
            import copy, json
            print(type(copy.copy(found[0])).__name__, type(found[0] | {}).__name__, json.dumps(list(found[0])))
            for key in found[0]:
                if key >= 0:
                    state.remove_outcome(key)
            tell()
            refused(found[0].__setitem__, 7, "x")
            refused(found[0].clear)
            """),
            """
            [3, 0, 0, 0, 0, 0, 0]
            [4, 1, 1, 1, 1, 1, 1]
            True True True True
            True [-2, -1, 0, 1] [-2, -1, 0, 1] ['preempted', 'aborted', 'success', 'n']
            [4, 1, 1, 1, 0, 0, 0]
            dict dict [-2, -1, 0, 1]
            [2, 1, 1, 1, 0, 0, 0]
            TypeError
            TypeError
            """,
        )

    def test_an_id_may_change(self):
        self.check(
            """
            root, leaf = HierarchyState("root", "R"), ExecutionState("leaf", "L")
            root.add_state(leaf)
            root.set_start_state(leaf)
            leaf.change_state_id("NEW")
            print(list(root.states), root.states["NEW"] is leaf, root.start_state_id, leaf.get_path())
            root.change_state_id("TOP")
            print(leaf.get_path())
            """,
            """
            ['NEW'] True NEW R/NEW
            TOP/NEW
            """,
        )

    def test_a_folder_may_be_replaced_as_a_whole(self):
        self.check(
            """
            root = HierarchyState("root", "R")
            root.add_state(ExecutionState("leaf", "L"))
            machine, folder = StateMachine(root), os.environ["OUT"] + "/m"
            storage.save_state_machine_to_path(machine, folder)
            open(folder + "/foreign", "w").close()
            storage.save_state_machine_to_path(machine, folder)
            print(os.path.exists(folder + "/foreign"))
            storage.save_state_machine_to_path(machine, folder, delete_old_state_machine=True)
            print(os.path.exists(folder + "/foreign"), os.listdir(os.environ["OUT"]))
            print(list(storage.load_state_machine_from_path(folder).root_state.states))
            """,
            """
            True
            False ['m']
            ['L']
            """,
        )

    def test_copies_stand_alone(self):
        self.check(
            """
            from copy import copy
            root, leaf = HierarchyState("root", "R"), ExecutionState("leaf", "L")
            root.add_state(leaf)
            leaf.semantic_data["a"] = "b"
            again = copy(leaf)
            again.name = "again"
            print(again.state_id, again.parent, again.semantic_data, leaf.name, len(root.add_state(again)))
            other = copy(StateMachine(root))
            print(other.root_state is root, sorted(other.root_state.states) == sorted(root.states), other.file_system_path)
            """,
            """
            L None {'a': 'b'} leaf 6
            False True None
            """,
        )

    def test_connections_of_several_states(self):
        self.check(
            """
            root = HierarchyState("root", "R")
            for name in "ABC":
                root.add_state(ExecutionState(name, name))
            root.set_start_state("A")
            root.add_transition("A", 0, "B", None)
            root.add_transition("B", 0, "C", None)
            lines, flows = root.get_connections_for_state_and_scoped_variables(["A", "B"], [])
            print({kind: [line.to_state for line in found] for kind, found in lines.items()}, flows["enclosed"])
            """,
            """
            {'enclosed': ['B'], 'ingoing': ['A'], 'outgoing': ['C']} []
            """,
        )

    def test_values_that_no_file_keeps_are_refused(self):
        self.check(
            """
            state = ExecutionState("s")
            refused(state.add_input_data_port, "a", object, object())
            refused(state.add_input_data_port, "b", dict, {1: 1, "a": 2})
            refused(state.add_input_data_port, "c", type, int)
            refused(state.add_input_data_port, "d", set, {1})
            print([port.name for port in state.input_data_ports.values()])
            """,
            """
            TypeError
            TypeError
            done
            done
            ['c', 'd']
            """,
        )

    def test_a_value_that_is_nested_too_deep_is_refused(self):
        self.check(
            """
            def nested(levels):
                value = 1
                for _ in range(levels):
                    value = [value]
                return value
            state = ExecutionState("s")
            refused(state.add_input_data_port, "a", list, nested(189))
            refused(state.add_input_data_port, "b", list, nested(190))
            refused(state.add_input_data_port, "c", list, nested(100_000))
            print([port.name for port in state.input_data_ports.values()])
            """,
            """
            done
            RecursionError
            RecursionError
            ['a']
            """,
        )

    def test_what_was_saved_is_loaded(self):
        self.check(
            EVERYTHING
            + """
            print(machine.file_system_path == os.environ["OUT"], machine.marked_dirty)
            loaded = storage.load_state_machine_from_path(os.environ["OUT"])
            again = loaded.root_state
            print(again.name, again.description == root.description, sorted(again.states), loaded.version)
            print(again.states["FIRSTX"].semantic_data, again.scoped_variables[2].default_value)
            print(again.output_data_ports[1].default_value, os.path.basename(again.states["FIRSTX"].file_system_path))
            print(loaded.get_state_by_path("ROOTID/SECOND/ONEXXX").parent is again.states["SECOND"], loaded.marked_dirty)
            again.name = "another"
            print(loaded.marked_dirty)
            storage.save_state_machine_to_path(loaded, os.environ["OUT"])
            print(storage.load_state_machine_from_path(os.environ["OUT"]).root_state.name)
            """.replace("\n            ", "\n"),
            """
            True False
            root *1* True ['FIRSTX', 'SECOND', 'THIRDX'] 1.0
            {'tool': {'gripper': 'open'}} 3
            {'a': [1, 2.5, None], 'b': (True, 'x')} first_FIRSTX
            True False
            True
            another
            """,
        )


class Guide(unittest.TestCase):
    def setUp(self):
        guide = (ROOT / "docs/guide/building.md").read_text(encoding="utf-8")
        self.program = guide.partition("```python\n")[2].partition("```")[0]
        self.shown = guide.partition("$ python3 counting.py\n")[2].partition("$")[0]

    def test_the_guide_works(self):
        self.assertEqual(call(self.program), self.shown)

    @unittest.skipIf(REFERENCE is None, "RAFCON_REFERENCE_PYTHON is not set")
    def test_the_guide_works_in_the_reference(self):
        self.assertEqual(building.shown(call(self.program, REFERENCE, "")), self.shown)


class Libraries(unittest.TestCase):
    LIBRARY = """
        leaf = ExecutionState("leaf", "LEAFXX")
        leaf.add_input_data_port("time", float, 1.0)
        leaf.add_output_data_port("word", str, "x")
        storage.save_state_machine_to_path(StateMachine(leaf, version="2"), os.environ["OUT"] + "/lib/deep/leaf")
        global_config.set_config_value("LIBRARY_PATHS", {"lib": os.environ["OUT"] + "/lib"})
        library_manager.initialize()
    """

    def check(self, program, expected):
        program = textwrap.dedent(self.LIBRARY) + textwrap.dedent(program)
        self.assertEqual(call(program), textwrap.dedent(expected).lstrip("\n"))

    def test_a_library_is_put_in(self):
        self.check(
            """
            state = LibraryState("lib/deep", "leaf", "2", "mine", "L")
            print(state.name, state.version, state.state_copy, state.state_copy.parent is state)
            print(state.input_data_port_runtime_values, state.use_runtime_value_output_data_ports)
            state.set_input_runtime_value(0, "7.5")
            state.set_use_output_runtime_value(1, False)
            print(state.input_data_port_runtime_values, state.use_runtime_value_output_data_ports)
            root = HierarchyState("root", "R")
            root.add_state(state)
            print(state.state_copy.get_path(), library_manager.get_library_instance("lib/deep", "leaf").name)
            """,
            """
            mine 2 ExecutionState with name 'leaf' and id 'LEAFXX' True
            {0: 1.0} {1: True}
            {0: 7.5} {1: False}
            R/L/LEAFXX leaf
            """,
        )

    def test_its_interface_is_fixed(self):
        self.check(
            """
            state = LibraryState("lib/deep", "leaf")
            refused(state.add_outcome, "x")
            refused(state.add_input_data_port, "x", int)
            refused(state.remove_output_data_port, 1)
            refused(state.set_input_runtime_value, 99, 1)
            refused(LibraryState, "lib/deep", "nope")
            """,
            """
            NotImplementedError
            NotImplementedError
            NotImplementedError
            KeyError
            LibraryNotFoundException
            """,
        )


@unittest.skipIf(REFERENCE is None, "RAFCON_REFERENCE_PYTHON is not set")
class Reference(unittest.TestCase):
    """The same program with both."""

    def test_the_same_files_are_written(self):
        with tempfile.TemporaryDirectory() as ours, tempfile.TemporaryDirectory() as theirs:
            call(EVERYTHING, OUT=ours)
            call(EVERYTHING, REFERENCE, "", OUT=theirs)
            self.assertEqual(building.files(ours), building.files(theirs))

    def test_changes_leave_the_same(self):
        self.assertEqual(call(CHANGES), building.shown(call(CHANGES, REFERENCE, "")))

    def test_defaults_are_kept_alike(self):
        self.assertEqual(call(TYPES), building.shown(call(TYPES, REFERENCE, "")))

    def test_collections_are_live_alike(self):
        ours, theirs = call(COLLECTIONS).splitlines(), building.shown(call(COLLECTIONS, REFERENCE, "")).splitlines()
        sizes = [index for index, line in enumerate(ours) if line.startswith("[")]
        self.assertEqual([ours[index] for index in sizes], [theirs[index] for index in sizes])

    def test_the_same_is_refused(self):
        self.assertEqual(call(REFUSALS), building.shown(call(REFUSALS, REFERENCE, "")))


if __name__ == "__main__":
    unittest.main()
