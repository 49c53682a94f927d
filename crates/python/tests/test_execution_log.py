"""Logs of runs as tables: those of the reference's format, and those that a program writes."""

import pickle
import textwrap
import unittest

import stage  # noqa: F401, it puts the package on the path
from building import call
from rafcon.utils import execution_log
from test_summary import TWO


def entry(number, item_type, run, path, kind="HierarchyState", before=None, **more):
    """An entry of a log; numbers are times, too."""
    found = {
        "history_item_id": f"{number:03}",
        "prev_history_item_id": None if before is None else f"{before:03}",
        "item_type": item_type,
        "run_id": run,
        "path": path,
        "state_name": path.rpartition("/")[2].lower(),
        "state_type": kind,
        "timestamp": float(number),
        "semantic_data": {},
        "call_type": "EXECUTE",
        **more,
    }
    if item_type in ("CallItem", "ReturnItem"):
        for name in ("input_output_data", "scoped_data"):
            found[name] = {key: pickle.dumps(value) for key, value in more.get(name, {}).items()}
    if item_type == "ReturnItem":
        found.update(outcome_name="success", outcome_id=0)
    return found


#: R has A and then the barrier B with the branches X and Y.
LOG = [
    entry(1, "StateMachineStartItem", "start", ""),
    entry(2, "CallItem", "r", "R", before=1),
    entry(3, "CallItem", "a", "R/A", "ExecutionState", before=2, input_output_data={"i": 1}, scoped_data={"s": [2]}),
    entry(4, "ReturnItem", "a", "R/A", "ExecutionState", before=3, input_output_data={"o": 3}),
    entry(5, "CallItem", "b", "R/B", "BarrierConcurrencyState", before=4),
    entry(6, "ConcurrencyItem", "b", "R/B", "BarrierConcurrencyState", before=5),
    entry(7, "CallItem", "x", "R/B/X", "ExecutionState", before=6),
    entry(8, "CallItem", "y", "R/B/Y", "ExecutionState", before=6),
    entry(9, "ReturnItem", "x", "R/B/X", "ExecutionState", before=7),
    entry(10, "ReturnItem", "y", "R/B/Y", "ExecutionState", before=8),
    entry(11, "ReturnItem", "b", "R/B", "BarrierConcurrencyState", before=6),
    entry(12, "CallItem", "c", "R/C", "ExecutionState", before=11),
]
ITEMS = {item["history_item_id"]: item for item in LOG}


class Structures(unittest.TestCase):
    def test_raw(self):
        start, previous, following, concurrent, grouped = execution_log.log_to_raw_structure(ITEMS)
        self.assertEqual((start["run_id"], previous["003"], following["003"]), ("start", "002", "004"))
        self.assertEqual((concurrent, following["006"]), ({"006": ["007", "008"]}, "011"))
        self.assertEqual([item["item_type"] for item in grouped["b"]], ["CallItem", "ConcurrencyItem", "ReturnItem"])

    def test_collapsed(self):
        start, following, concurrent, hierarchy, items = execution_log.log_to_collapsed_structure(ITEMS)
        self.assertEqual(start["run_id"], "start")
        self.assertEqual(following, {"start": "r", "a": "b", "b": "c"})
        self.assertEqual((concurrent, hierarchy), ({"b": ["x", "y"]}, {"r": "a"}))
        wanted = ("data_ins", "data_outs", "scoped_data_ins", "timestamp_call", "timestamp_return", "outcome_name")
        self.assertEqual([items["a"][name] for name in wanted], [{"i": 1}, {"o": 3}, {"s": [2]}, 3.0, 4.0, "success"])
        self.assertEqual((items["c"]["timestamp_return"], items["c"]["outcome_id"]), (None, None))

    def test_what_ends_a_container_leads_to_what_follows_it(self):
        log = [
            entry(1, "CallItem", "r", "R"),
            entry(2, "CallItem", "g", "R/G", before=1),
            entry(3, "CallItem", "a", "R/G/A", before=2),
            entry(4, "CallItem", "b", "R/B", before=3),
        ]
        items = {item["history_item_id"]: item for item in log}
        _start, following, *_rest = execution_log.log_to_collapsed_structure(items, full_next=True)
        self.assertEqual(following, {"g": "b", "a": "b"})

    def test_a_value_that_cannot_be_read(self):
        broken = {**ITEMS["003"], "input_output_data": {"i": b"no pickle", "!lock": ("cannot pickle", "<lock>")}}
        items = {**ITEMS, "003": broken}
        with self.assertRaises(pickle.UnpicklingError):
            execution_log.log_to_collapsed_structure(items)
        with self.assertLogs("rafcon", "ERROR"):
            *_relations, found = execution_log.log_to_collapsed_structure(items, False, True)
        self.assertEqual(found["a"]["data_ins"], {"!lock": ("cannot pickle", "<lock>")})


class Files(unittest.TestCase):
    def test_a_program_reads_what_its_run_did(self):
        program = """
        import shelve
        from rafcon.utils import execution_log
        global_config.set_config_value("EXECUTION_LOG_PATH", os.environ["OUT"] + "/logs")
        two.description = "The second."
        engine.start(machine.state_machine_id)
        engine.join()
        name = machine.get_last_execution_log_filename()
        print(os.path.dirname(name) == os.environ["OUT"] + "/logs", name.endswith("_rafcon_execution_log_root.shelve"))
        with shelve.open(name) as log:
            print(len(log))
            _start, *relations, items = execution_log.log_to_collapsed_structure(log)
        short = lambda text: text.replace("run_id.0000000000000000000", "")
        print(*(short(str(relation)) for relation in relations))
        print(items.pop(min(items))["state_name"])
        for item in items.values():
            print(item["state_name"], item["state_type"], item["outcome_name"], item["description"])
        """
        self.assertEqual(
            call(TWO + textwrap.dedent(program)).splitlines(),
            [
                "one",
                "two",
                "True True",
                "11",
                "{'1': '2', '3': '5'} {} {'2': '3', '3': '4'}",
                "StateMachineStartItem",
                "root HierarchyState success None",
                "group HierarchyState success None",
                "one ExecutionState success None",
                "two ExecutionState success The second.",
            ],
        )

    def test_branches_stand_side_by_side(self):
        program = """
        import shelve
        from rafcon.utils import execution_log
        global_config.set_config_value("EXECUTION_LOG_PATH", os.environ["OUT"] + "/logs")
        decider = DeciderState("decider", "unique_decider_state_id")
        decider.script_text = one.script_text
        barrier = BarrierConcurrencyState("barrier", "BARRRR", decider_state=decider)
        root.remove_state("TWOXXX")
        barrier.add_state(two)
        root.add_state(barrier)
        barrier.add_transition("unique_decider_state_id", 0, "BARRRR", 0)
        root.add_transition("GROUPI", 0, "BARRRR", None)
        root.add_transition("BARRRR", 0, "ROOTID", 0)
        engine.start(machine.state_machine_id)
        engine.join()
        with shelve.open(machine.get_last_execution_log_filename()) as log:
            print([log[key]["item_type"] for key in sorted(log)].count("ConcurrencyItem"))
            _start, following, concurrent, _hierarchy, items = execution_log.log_to_collapsed_structure(log)
        name = lambda run: items[run]["state_name"]
        print({name(run): [name(branch) for branch in branches] for run, branches in concurrent.items()})
        print({name(run): name(after) for run, after in following.items()})
        """
        self.assertEqual(
            call(TWO + textwrap.dedent(program)).splitlines()[-3:],
            [
                "1",
                "{'barrier': ['two', 'decider']}",
                "{'StateMachineStartItem': 'root', 'group': 'barrier'}",
            ],
        )


if __name__ == "__main__":
    unittest.main()
