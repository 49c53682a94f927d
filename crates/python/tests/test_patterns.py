"""Observers, singletons and the other helpers that programs build on."""

import hashlib
import logging
import os
import pathlib
import tempfile
import threading
import time
import unittest
from unittest import mock

import stage  # noqa: F401, it puts the package on the path
from rafcon.core import id_generator
from rafcon.core.config import Config, ObservableConfig
from rafcon.core.state_elements.scope import generate_time_stamp
from rafcon.core.storage import storage
from rafcon.design_patterns.observer.observable import Observable, ObservableMetaclass, Signal
from rafcon.design_patterns.observer.observer import Observer
from rafcon.design_patterns.observer.wrappers import DictWrapper, ListWrapper, SetWrapper
from rafcon.design_patterns.singleton import Singleton
from rafcon.utils import classproperty, decorators, dict_operations, filesystem, geometry, i18n, log_helpers
from rafcon.utils import multi_event, storage_utils
from rafcon.utils.constants import BY_EXECUTION_TRIGGERED_OBSERVABLE_STATE_METHODS
from rafcon.utils.hashable import Hashable
from rafcon.utils.timer import Timer
from rafcon.utils.vividict import Vividict


class Watched(Observable):
    def __init__(self):
        Observable.__init__(self)
        self._value = None

    @property
    def value(self):
        return self._value

    @value.setter
    @Observable.observed
    def value(self, value):
        self._value = value

    @Observable.observed
    def add(self, one, other=1):
        """Adds."""
        if one is None:
            raise ValueError("nothing")
        return one + other


class Observables(unittest.TestCase):
    def setUp(self):
        self.heard = []
        self.watched = Watched()

    def observe(self, name):
        self.watched.add_observer(
            self,
            name,
            lambda observable, args: self.heard.append((observable is self.watched, *args[1:])),
            lambda _observable, result, args: self.heard.append((repr(result), *args[1:])),
        )

    def test_a_call(self):
        self.observe("add")
        self.assertEqual((self.watched.add(1), self.watched.add(1, other=4)), (2, 5))
        self.assertEqual(self.heard, [(True, 1), ("2", 1), (True, 1, 4), ("5", 1, 4)])
        self.assertEqual((Watched.add.__name__, Watched.add.__doc__), ("add", "Adds."))

    def test_a_call_that_fails(self):
        self.observe("add")
        with self.assertRaises(ValueError):
            self.watched.add(None)
        self.assertEqual(self.heard[1][0], "ValueError('nothing')")

    def test_an_assignment(self):
        self.observe("value")
        self.watched.value = 20
        self.assertEqual(self.heard, [(True, 20), ("None", 20)])

    def test_another_pair_of_the_same_observer_replaces_the_first(self):
        self.observe("value")
        self.watched.add_observer(self, "value", notify_after_function=lambda *_told: self.heard.append("new"))
        self.watched.value = 1
        self.assertEqual(self.heard, ["new"])

    def test_a_configuration(self):
        config = Config()
        self.assertIsInstance(config, ObservableConfig)
        config.add_observer(self, "set_config_value", notify_after_function=lambda *told: self.heard.append(told[2][1:]))
        config.set_config_value("OWN", 3)
        self.assertEqual((self.heard, config.get_config_value("OWN")), ([("OWN", 3)], 3))

    def test_names_of_what_observers_hear_because_a_machine_runs(self):
        names = ["state_execution_status", "_add_new_execution_history", "clear_execution_histories"]
        self.assertEqual(BY_EXECUTION_TRIGGERED_OBSERVABLE_STATE_METHODS, names)

    def test_another_object_of_the_class_is_not_observed(self):
        self.observe("value")
        Watched().value = 1
        self.assertEqual(self.heard, [])


@ObservableMetaclass.add(ObservableMetaclass)
class Model(Observer):
    number = 0
    names = ["a"]
    done = Signal()

    __observables__ = ("number", "names", "done")

    def __init__(self):
        super().__init__()


class Watcher(Observer):
    def __init__(self, model):
        super().__init__(model)
        self.heard = []

    @Observer.observe("number", assign=True)
    def number_changed(self, model, name, info):
        self.heard.append((name, info["old"], info.new, info.assign, info.signal))

    @Observer.observe("names", before=True, after=True)
    @Observer.observe("done", signal=True)
    def names_changed(self, model, name, info):
        self.heard.append(
            (name, info.get("method_name"), "before" if info.before else "after" if info.after else info.arg)
        )


class Models(unittest.TestCase):
    def test_an_observer_hears_of_a_model(self):
        model = Model()
        watcher = Watcher(model)
        model.number += 1
        model.names.append("b")
        model.done.emit(7)
        self.assertEqual(
            watcher.heard,
            [
                ("number", 0, 1, True, False),
                ("names", "append", "before"),
                ("names", "append", "after"),
                ("done", None, 7),
            ],
        )
        watcher.relieve_model(model)
        model.number = 5
        self.assertEqual((len(watcher.heard), model.number, list(model.names)), (4, 5, ["a", "b"]))

    def test_an_assigned_list_is_heard_of_and_the_old_one_no_more(self):
        model = Model()
        watcher = Watcher(model)
        old = model.names
        model.names = []
        old.append("x")
        model.names.append("y")
        self.assertEqual([told[1:] for told in watcher.heard], [("append", "before"), ("append", "after")])

    def test_collections(self):
        for wrapper, calls, left in (
            (ListWrapper([]), ["append", "extend", "__setitem__", "clear"], []),
            (SetWrapper({1}), ["add", "remove"], {2}),
            (DictWrapper({}), ["__setitem__", "update"], {"a": 1, "b": 2}),
        ):
            heard = []
            wrapper.notify_before = lambda _instance, name, _args, _kwargs: heard.append(name)
            wrapper.notify_after = lambda _instance, name, *_rest: heard.append(name)
            if isinstance(wrapper, ListWrapper):
                wrapper.append(1)
                wrapper.extend([2])
                wrapper[0] = 5
                wrapper.clear()
            elif isinstance(wrapper, SetWrapper):
                wrapper.add(2)
                wrapper.remove(1)
            else:
                wrapper["a"] = 1
                wrapper.update(b=2)
            self.assertEqual(heard, [name for name in calls for _side in range(2)])
            self.assertEqual(wrapper, left)


class Singletons(unittest.TestCase):
    def test_there_is_one(self):
        @Singleton
        class One:
            def __init__(self, number=1):
                self.number = number

        self.assertIs(One.instance(2), One.instance())
        self.assertEqual((One.instance().number, isinstance(One.instance(), One)), (2, True))
        with self.assertRaises(TypeError):
            One()


class Helpers(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_hashes(self):
        def hashed(value):
            found = hashlib.sha256()
            Hashable.update_hash_from_dict(found, value)
            return found.hexdigest()

        self.assertEqual(hashed({"a": {1, 2}, "b": [1]}), hashed({"b": [1], "a": {2, 1}}))
        self.assertNotEqual(hashed([1, 2]), hashed([2, 1]))
        self.assertEqual(hashed("abc"), hashlib.sha256(b"abc").hexdigest())

        class Part(Hashable):
            def __init__(self, value):
                self.value = value

        self.assertEqual(Part(1).mutable_hash().digest(), Part(1).mutable_hash().digest())
        self.assertNotEqual(Part(1).mutable_hash().digest(), Part(2).mutable_hash().digest())

    def test_ids(self):
        self.assertEqual(id_generator.generate_data_port_id([0, 1, 5]), 2)
        self.assertEqual(id_generator.generate_outcome_id([-2, -1, 0, 3]), 1)
        self.assertEqual(id_generator.generate_semantic_data_key(["semantic data key 0"]), "semantic data key 1")
        self.assertEqual(id_generator.state_id_generator(2, "AB", ["AA", "AB", "BA"]), "BB")
        self.assertRegex(id_generator.state_id_generator(), "^[A-Z]{6}$")
        self.assertRegex(id_generator.global_variable_id_generator(), "^[A-Z]{10}$")
        for make in (
            id_generator.generate_transition_id,
            id_generator.generate_data_flow_id,
            id_generator.generate_state_machine_id,
            id_generator.generate_script_id,
            id_generator.generate_state_name_id,
        ):
            self.assertEqual(make() + 1, make())
        self.assertNotEqual(id_generator.run_id_generator(), id_generator.run_id_generator())
        self.assertIn(id_generator.experiment_id, id_generator.history_item_id_generator())

    def test_files(self):
        text = self.folder / "deep" / "t.txt"
        with self.assertRaises(FileNotFoundError):
            filesystem.write_file(str(text), "hällo")
        filesystem.write_file(str(text), "hällo", create_full_path=True)
        self.assertEqual(filesystem.read_file(str(text)), "hällo")
        self.assertEqual(filesystem.read_file(str(text.parent), "t.txt"), "hällo")
        self.assertIsNone(filesystem.read_file(str(self.folder / "none")))
        filesystem.make_file_executable(str(text))
        self.assertTrue(os.access(text, os.X_OK))
        filesystem.copy_file_or_folder(str(text.parent), str(self.folder / "copy"))
        filesystem.copy_file_or_folder(str(text), str(self.folder / "t2.txt"))
        paths = [str(self.folder / name) for name in ("copy/t.txt", "none", "t2.txt")]
        filesystem.clean_file_system_paths_from_not_existing_paths(paths)
        self.assertEqual([os.path.basename(path) for path in paths], ["t.txt", "t2.txt"])
        self.assertEqual(filesystem.separate_folder_path_and_file_name("/a/b"), ("/a", "b"))
        self.assertEqual(filesystem.separate_folder_path_and_file_name(str(self.folder)), (str(self.folder), None))
        filesystem.make_tarfile(str(self.folder / "x.tar"), str(self.folder / "copy"))
        self.assertEqual((self.folder / "x.tar").read_bytes()[:2], b"\x1f\x8b")

    def test_dictionaries_in_files(self):
        path = self.folder / "d.json"
        storage_utils.write_dict_to_json({"b": (1, {2}), "a": int}, path)
        self.assertEqual(storage_utils.load_objects_from_json(path), {"a": int, "b": (1, {2})})
        self.assertEqual(storage_utils.load_objects_from_json(path, as_dict=True)["a"], {"__type__": "__builtin__.int"})
        time.strptime(storage_utils.get_current_time_string(), storage_utils.TIME_STRING_FORMAT)

    def test_files_of_states(self):
        path = storage.get_core_data_path(str(self.folder))
        self.assertEqual(path, str(self.folder / "core_data.json"))
        with self.assertRaisesRegex(ValueError, "there is no file .*core_data.json"):
            storage.load_data_file(path)
        stored = {"outcomes": {"0": {"__jsonqualname__": "rafcon.core.state_elements.logical_port.Outcome"}}}
        storage_utils.write_dict_to_json(stored, path)
        self.assertEqual(storage.load_data_file(path), stored)

    def test_nested_dictionaries_become_plain_ones(self):
        nested = Vividict({"tool": {"gripper": "open"}})
        plain = nested.to_dict()
        self.assertEqual((plain, type(plain), type(plain["tool"])), ({"tool": {"gripper": "open"}}, dict, dict))
        plain["tool"]["gripper"] = "shut"
        self.assertEqual(nested["tool"]["gripper"], "open")

    def test_a_timer_adds_up_or_begins_anew(self):
        for continues, both_s in ((True, 3), (False, 2)):
            with mock.patch("rafcon.utils.timer.time") as clock, self.assertLogs("own") as logged:
                clock.perf_counter.side_effect = [0, 1, 5, 7]
                timer = Timer(logging.getLogger("own"), "work", continues)
                starts = [timer.start(), timer.stop("first"), timer.start(), timer.stop()]
            self.assertEqual((starts, timer.count, timer.duration), ([1, None, 2, None], 2, both_s))
            self.assertEqual(logged.output, ["INFO:own:work first took 1.000000 s", f"INFO:own:work took {both_s}.000000 s"])

    def test_a_time_stamp_is_in_microseconds(self):
        with mock.patch("time.time", return_value=1.5):
            stamp = generate_time_stamp()
        self.assertEqual((stamp, type(stamp)), (1_500_000, int))

    def test_geometry(self):
        self.assertEqual((geometry.dist((0, 0), (3, 4)), geometry.deg2rad(180)), (5, geometry.pi))
        self.assertEqual([geometry.equal((1.04, 2), (1, 2), digit) for digit in (None, 1)], [False, True])
        self.assertEqual(
            [geometry.point_left_of_line((0, y), (0, 0), (1, 0)) for y in (1, -1, 0)], [False, True, False]
        )
        boxes = [((3, 0), (1, 1)), ((3, 4), (1, 1)), ((0.5, 0.5), (1, 1))]
        distances = [geometry.cal_dist_between_2_coord_frame_aligned_boxes((0, 0), (1, 1), *box) for box in boxes]
        self.assertEqual([round(distance, 3) for distance in distances], [2, 3.606, 0])

    def test_small_ones(self):
        thing = object()
        self.assertTrue(dict_operations.check_if_dict_contains_object_reference_in_values(thing, {"a": thing}))
        self.assertFalse(dict_operations.check_if_dict_contains_object_reference_in_values([], {"a": []}))

        class Named:
            @classproperty
            def name(cls):
                return cls.__name__

            @classproperty
            @classmethod
            def other(cls):
                return cls.__name__

        self.assertEqual((Named.name, Named.other, Named().name), ("Named", "Named", "Named"))
        first, second = threading.Event(), threading.Event()
        both = multi_event.create(first, second)
        second.set()
        self.assertTrue(both.is_set() and multi_event.create([first, second]).is_set())
        self.assertEqual(multi_event.create(first).is_set(), False)

    def test_a_function_is_not_called_while_it_runs(self):
        entered, go_on = threading.Event(), threading.Event()

        @decorators.avoid_parallel_execution
        def work():
            entered.set()
            go_on.wait()
            return "done"

        thread = threading.Thread(target=work)
        thread.start()
        entered.wait()
        self.assertIsNone(work())
        go_on.set()
        thread.join()
        self.assertEqual(work(), "done")

    def test_views_of_a_log(self):
        class View:
            def __init__(self):
                self.seen = []

            def print_message(self, message, level):
                self.seen.append((message, level))

        view = View()
        handler = log_helpers.LoggingViewHandler()
        handler.addFilter(log_helpers.NoHigherLevelFilter(logging.ERROR))
        log_helpers.LoggingViewHandler.add_logging_view("own", view)
        for level in (logging.INFO, logging.ERROR):
            handler.handle(logging.LogRecord("rafcon", level, "", 0, "text %s", (level,), None))
        log_helpers.LoggingViewHandler.remove_logging_view("own")
        handler.handle(logging.LogRecord("rafcon", logging.INFO, "", 0, "later", (), None))
        self.assertEqual(view.seen, [("text 20", 20)])

    def test_texts_are_themselves_without_a_translation(self):
        import builtins

        self.addCleanup(lambda: builtins.__dict__.pop("_", None))
        with mock.patch.dict(os.environ, LC_ALL="nowhere"), self.assertLogs("rafcon", "WARNING") as logged:
            i18n.setup_l10n()
        self.assertEqual((builtins._("Remove"), len(logged.output)), ("Remove", 1))


if __name__ == "__main__":
    unittest.main()
