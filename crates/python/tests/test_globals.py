"""Global variables: values, types, locks, and who waits for whom."""

import threading
import unittest

import stage
from rafcon.core.custom_exceptions import StatePreempted
from rafcon.core.global_variable_manager import GlobalVariableManager


class Uncopyable:
    def __deepcopy__(self, memo):
        raise ValueError("cannot be copied")


class Call(threading.Thread):
    """A call on a thread of its own, perhaps as the script of a state; ``outcome`` is what came of it."""

    def __init__(self, function, *arguments, place=None, **named):
        threading.Thread.__init__(self, daemon=True)
        self.place = place
        self.call = lambda: function(*arguments, **named)
        self.start()

    def run(self):
        if self.place is not None:
            stage.enter(self.place)
        try:
            self.outcome = self.call()
        except BaseException as error:
            self.outcome = error

    def result(self):
        self.join()
        return self.outcome


class Watched(GlobalVariableManager):
    """Says when so many calls wait."""

    def __init__(self):
        GlobalVariableManager.__init__(self)
        self.queued = threading.Semaphore(0)

    def _wait(self, key, waiter):
        sleep = waiter.sleep

        def announced_sleep():
            self.queued.release()
            return sleep()

        waiter.sleep = announced_sleep
        return GlobalVariableManager._wait(self, key, waiter)


class Values(unittest.TestCase):
    def setUp(self):
        self.gvm = GlobalVariableManager()

    def test_a_port_default_runs_no_code_of_the_value(self):
        # The engine is locked meanwhile: a copy that waits for another state would wait for ever.
        copies = []

        class Counted:
            def __deepcopy__(self, memo):
                copies.append(self)
                return Counted()

        self.gvm.set_variable("a", Counted())
        copies.clear()
        found, value, _kept = self.gvm._resolve("a")
        self.assertTrue(found)
        self.assertIsInstance(value, Counted)
        self.assertEqual(copies, [])

    def test_a_value_is_copied_both_ways(self):
        mine = [1]
        self.gvm.set_variable("list", mine)
        mine.append(2)
        self.gvm.get_variable("list").append(3)
        self.assertEqual(self.gvm.get_variable("list"), [1])

    def test_by_reference_it_is_the_object_itself(self):
        mine = Uncopyable()
        self.gvm.set_variable("thing", mine, per_reference=True)
        self.assertIs(self.gvm.get_variable("thing"), mine)
        self.assertIs(self.gvm.get_variable("thing", per_reference=True), mine)
        self.assertTrue(self.gvm.variable_can_be_referenced("thing"))
        with self.assertRaises(ValueError):
            self.gvm.get_variable("thing", per_reference=False)

    def test_a_copy_cannot_be_had_by_reference(self):
        self.gvm.set_variable("a", 1)
        with self.assertRaises(RuntimeError):
            self.gvm.get_variable("a", per_reference=True)

    def test_what_is_not_there(self):
        self.assertIsNone(self.gvm.get_variable("a"))
        self.assertEqual(self.gvm.get_variable("a", default=5), 5)
        self.assertFalse(self.gvm.is_locked("a"))
        self.assertIsNone(self.gvm.get_representation("a"))
        with self.assertRaises(AttributeError):
            self.gvm.delete_variable("a")
        with self.assertRaises(KeyError):
            self.gvm.unlock_variable("a", "key")
        with self.assertLogs("rafcon", "ERROR"):
            self.assertFalse(self.gvm.lock_variable("a", block=True))

    def test_a_name_is_a_text(self):
        self.gvm.set_variable(7, "seven")
        self.assertEqual(self.gvm.get_variable("7"), "seven")
        self.assertTrue(self.gvm.variable_exist(7) and self.gvm.variable_exists("7"))

    def test_names_are_found_by_how_they_begin(self):
        for name in ("arm_left", "arm_right", "the_arm"):
            self.gvm.set_variable(name, 0)
        self.assertEqual(self.gvm.get_all_keys_starting_with("arm"), ["arm_left", "arm_right"])
        self.assertEqual(self.gvm.get_all_keys(), ["arm_left", "arm_right", "the_arm"])

    def test_a_failing_copy_changes_nothing(self):
        self.gvm.set_variable("a", 1)
        with self.assertRaises(ValueError):
            self.gvm.set_variable("a", Uncopyable())
        self.assertEqual(self.gvm.get_variable("a"), 1)
        self.assertFalse(self.gvm.is_locked("a"))

    def test_a_default_reads_a_locked_variable_without_waiting(self):
        self.gvm.set_variable("a", [1])
        self.gvm.lock_variable("a")
        self.assertEqual(self.gvm._resolve("a"), (True, [1], None))
        self.assertEqual(self.gvm._resolve("b"), (False, None, None))


class Types(unittest.TestCase):
    def setUp(self):
        self.gvm = GlobalVariableManager()

    def check(self, data_type, value, accepted):
        try:
            self.gvm.set_variable("v", value, data_type=data_type)
            self.assertTrue(accepted, (data_type, value))
        except TypeError:
            self.assertFalse(accepted, (data_type, value))

    def test_a_value_is_of_its_type_or_below(self):
        self.check(object, [1], True)
        self.check(dict, {}, True)
        self.check(int, True, True)
        self.check(float, 1, True)
        self.check(int, 1.5, False)
        self.check(str, 1, False)
        self.check(list, (), False)
        self.check(float, True, False)
        self.check(int, None, True)

    def test_an_int_in_a_bool_variable_stays_possible(self):
        self.check(bool, 1, True)
        self.check(bool, object(), False)

    def test_the_type_stays_with_the_variable_and_goes_with_it(self):
        self.gvm.set_variable("v", 1, data_type=int)
        with self.assertRaises(TypeError):
            self.gvm.set_variable("v", "text")
        self.assertIs(self.gvm.get_data_type("v"), int)
        self.gvm.delete_variable("v")
        self.assertFalse(self.gvm.data_type_exist("v"))
        self.gvm.set_variable("v", "text")
        self.assertIs(self.gvm.get_data_type("v"), type(None))

    def test_a_type_is_a_type(self):
        with self.assertRaises(TypeError):
            self.gvm.set_variable("v", 1, data_type="int")


class Locks(unittest.TestCase):
    def setUp(self):
        stage.native.clear([stage.described("execution", "A", "a", "A")])
        self.gvm = Watched()
        self.gvm.set_variable("v", 1)
        self.key = self.gvm.lock_variable("v")

    def waiting(self, *arguments, **named):
        call = Call(*arguments, **named)
        self.gvm.queued.acquire()
        return call

    def test_a_key_is_ten_capital_letters(self):
        self.assertRegex(self.key, "^[A-Z]{10}$")

    def test_its_owner_goes_on(self):
        self.gvm.set_locked_variable("v", self.key, 2)
        self.assertEqual(self.gvm.get_locked_variable("v", self.key), 2)
        self.assertTrue(self.gvm.is_locked("v"))

    def test_a_wrong_key_is_refused(self):
        for call in (
            lambda: self.gvm.set_variable("v", 2, access_key="X"),
            lambda: self.gvm.get_variable("v", access_key="X"),
            lambda: self.gvm.unlock_variable("v", "X"),
            lambda: self.gvm.delete_variable("v"),
        ):
            with self.assertRaises(RuntimeError):
                call()

    def test_locking_again_without_waiting_is_false(self):
        with self.assertLogs("rafcon", "WARNING"):
            self.assertIs(self.gvm.lock_variable("v"), False)

    def test_unlocking_twice_is_false(self):
        self.assertTrue(self.gvm.unlock_variable("v", self.key))
        with self.assertLogs("rafcon", "ERROR"):
            self.assertFalse(self.gvm.unlock_variable("v", self.key))

    def test_force_needs_no_key(self):
        self.assertTrue(self.gvm.unlock_variable("v", None, force=True))

    def test_who_waits_to_write_keeps_nobody_from_writing(self):
        writer = self.waiting(self.gvm.set_variable, "v", 5)
        self.gvm.set_variable("other", 1)
        self.gvm.set_variable("v", 2, access_key=self.key)
        self.assertEqual(self.gvm.get_variable("v", access_key=self.key), 2)
        self.gvm.unlock_variable("v", self.key)
        self.assertIsNone(writer.result())
        self.assertEqual(self.gvm.get_variable("v"), 5)

    def test_first_come_first_served(self):
        seen = []

        def note(number):
            key = self.gvm.lock_variable("v", block=True)
            seen.append(number)
            self.gvm.unlock_variable("v", key)

        calls = [self.waiting(note, number) for number in range(20)]
        self.gvm.unlock_variable("v", self.key)
        for call in calls:
            call.result()
        self.assertEqual(seen, list(range(20)))

    def test_a_lock_is_handed_on_before_later_calls(self):
        locker = self.waiting(self.gvm.lock_variable, "v", block=True)
        reader = self.waiting(self.gvm.get_variable, "v")
        self.gvm.unlock_variable("v", self.key)
        key = locker.result()
        self.gvm.set_variable("v", 9, access_key=key)
        self.assertTrue(reader.is_alive())
        self.gvm.unlock_variable("v", key)
        self.assertEqual(reader.result(), 9)

    def test_a_reset_sets_everybody_free(self):
        calls = [
            self.waiting(self.gvm.get_variable, "v", default="gone"),
            self.waiting(self.gvm.lock_variable, "v", block=True),
            self.waiting(self.gvm.set_variable, "v", 3),
            self.waiting(self.gvm.lock_variable, "v", block=True),
            self.waiting(self.gvm.get_variable, "v"),
        ]
        with self.assertLogs("rafcon", "ERROR"):
            self.gvm.reset()
            self.assertEqual([call.result() for call in calls[:3]], ["gone", False, None])
        self.gvm.unlock_variable("v", calls[3].result())
        self.assertEqual(calls[4].result(), 3)

    def test_a_type_error_reaches_the_one_who_waited(self):
        self.gvm.set_variable("v", 1, access_key=self.key, data_type=int)
        writer = self.waiting(self.gvm.set_variable, "v", "text")
        self.gvm.unlock_variable("v", self.key)
        self.assertIsInstance(writer.result(), TypeError)

    def test_many_threads_count_together(self):
        self.gvm.unlock_variable("v", self.key)

        def count():
            for _ in range(200):
                key = self.gvm.lock_variable("v", block=True)
                value = self.gvm.get_locked_variable("v", key)
                self.gvm.set_locked_variable("v", key, value + 1)
                self.gvm.unlock_variable("v", key)

        for call in [Call(count) for _ in range(8)]:
            self.assertIsNone(call.result())
        self.assertEqual(self.gvm.get_variable("v"), 1 + 8 * 200)


class Preemption(unittest.TestCase):
    def setUp(self):
        stage.native.clear([stage.described("execution", "A", "a", "A")])
        self.gvm = Watched()
        self.gvm.set_variable("v", 1)
        self.key = self.gvm.lock_variable("v")
        self.state = stage.native.state_object(0)

    def test_it_ends_a_wait(self):
        call = Call(self.gvm.get_variable, "v", place=0)
        self.state._signals.until_waited_on()
        self.state._signals.preempted = True
        self.assertIsInstance(call.result(), StatePreempted)
        self.assertEqual(self.gvm.unlock_variable("v", self.key), True)
        self.assertEqual(self.gvm.get_variable("v"), 1)

    def test_the_end_of_the_lock_ends_the_wait_of_a_state_too(self):
        call = Call(self.gvm.get_variable, "v", place=0)
        self.state._signals.until_waited_on()
        self.gvm.unlock_variable("v", self.key)
        self.assertEqual(call.result(), 1)

    def test_a_script_that_has_not_looked_is_told_when_it_begins_to_wait(self):
        self.state._signals.preempted = True
        self.assertIsInstance(Call(self.gvm.get_variable, "v", place=0).result(), StatePreempted)

    def test_a_script_that_knows_waits_to_clean_up(self):
        self.state._signals.preempted = True

        def clean_up():
            self.assertTrue(self.state.preempted)
            self.gvm.set_variable("v", 2)

        self.clean_up(clean_up)

    def test_a_script_that_was_ended_waits_to_clean_up(self):
        self.state._signals.preempted = True

        def clean_up():
            try:
                self.gvm.get_variable("v")
            finally:
                self.gvm.set_variable("v", 2)

        self.clean_up(clean_up)

    def clean_up(self, script):
        call = Call(script, place=0)
        with self.state._signals.changed:
            self.state._signals.changed.wait_for(lambda: (8, None) in self.state._signals.waits)
        self.assertTrue(call.is_alive())
        self.gvm.unlock_variable("v", self.key)
        call.result()
        self.assertEqual(self.gvm.get_variable("v"), 2)

    def test_the_next_run_is_told_again(self):
        self.state._signals.preempted = True
        self.assertTrue(self.state.preempted)
        stage.native.live[0] = {"run_count": 2}
        self.assertIsInstance(Call(self.gvm.get_variable, "v", place=0).result(), StatePreempted)

    def test_it_passes_by_except_exception(self):
        self.assertFalse(issubclass(StatePreempted, Exception))


if __name__ == "__main__":
    unittest.main()
