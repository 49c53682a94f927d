"""The bounds of queues, frames and questions of ``rafcon.ros``, with a back end that only hands over."""

import io
import threading
import types
import unittest
import unittest.mock

import stage  # noqa: F401, it brings the package
from rafcon.ros import _native_frames as frames
from rafcon.ros import _native_actions, _services, _topics
from rafcon.ros._backend import SUCCEEDED, Field, MessageType, Qos, RosError, UnknownType
from rafcon.ros._native_actions import ActionServer
from rafcon.ros._native_callbacks import Callbacks
from rafcon.ros._native_descriptions import Descriptions
from rafcon.ros._liveness import Liveness
from rafcon.ros._types import Types

LINE = MessageType("p/msg/Line", (Field("data", "string"),))
REQUEST = MessageType("p/srv/Say_Request", (Field("data", "string"),))
RESPONSE = MessageType("p/srv/Say_Response", (Field("data", "string"),))


class Handed:
    """A back end that hands over what the test gives it."""

    def subscription(self, _topic, _type, _quality, hear):
        self.give = hear
        return types.SimpleNamespace(close=lambda: None, publishers=lambda: 1)

    def service(self, _name, _type, put):
        self.give = put
        return types.SimpleNamespace(close=lambda: None)

    def publishers_of(self, _topic):
        return []


class Here:
    """The node of a run that has no network."""

    ended = None

    def __init__(self):
        self.backend = Handed()
        self.types = Types(self._unknown)
        self.types.learn({each.name: each for each in (LINE, REQUEST, RESPONSE)})
        self.types.learn({"p/srv/Say": MessageType("p/srv/Say", ())})

    @staticmethod
    def _unknown(name):
        raise UnknownType(name)

    def absolute(self, name):
        return name

    def check(self):
        pass


class SlowCallback:
    """A callback that begins with the first item and ends with the test's permission."""

    def __init__(self, last):
        self.began, self.may_end, self.had_last = threading.Event(), threading.Event(), threading.Event()
        self.last = last
        self.texts = []

    def __call__(self, message):
        self.began.set()
        self.may_end.wait()
        self.texts.append(message.data)
        if message.data == self.last:
            self.had_last.set()
        return {"data": message.data}


class Queues(unittest.TestCase):
    def setUp(self):
        self.here = Here()

    def subscription(self, callback=None, depth=0):
        made = _topics.Subscription(self.here, "/line", "p/msg/Line", callback, Qos(depth=depth))
        self.addCleanup(made.close)
        return made

    def give(self, begin, end):
        for number in range(begin, end):
            self.here.backend.give({"data": str(number)})

    def test_of_messages_that_nobody_takes_the_newest_are_kept(self):
        for depth, most in ((0, 1000), (3, 3)):
            subscription = self.subscription(depth=depth)
            self.give(0, most + 1)
            found = [subscription.next(timeout=0).data for _ in range(most)]
            self.assertEqual(found, [str(number) for number in range(1, most + 1)])
            self.assertIsNone(subscription._taken(None))
            self.give(5, 6)
            self.assertEqual(subscription.next(timeout=0).data, "5")

    def check_slow(self, callback, give):
        """One item is worked on, 1,000 wait, one more takes the place of the oldest."""
        self.addCleanup(callback.may_end.set)
        give(0)
        callback.began.wait()
        for number in range(1, 1001):
            give(number)
        with self.assertLogs("rafcon", "WARNING") as logged:
            give(1001)
        self.assertIn("the callback is too slow, a message was dropped", logged.output[0])
        callback.may_end.set()
        callback.had_last.wait()
        self.assertEqual(callback.texts, [str(number) for number in (0, *range(2, 1002))])

    def test_a_callback_that_is_too_slow_loses_the_oldest_message_and_the_log_says_so(self):
        callback = SlowCallback("1001")
        self.subscription(callback)
        self.check_slow(callback, lambda number: self.give(number, number + 1))

    def test_a_service_that_is_too_slow_loses_the_oldest_request_and_the_log_says_so(self):
        callback, answered = SlowCallback("1001"), []
        self.addCleanup(setattr, _services, "node", _services.node)
        _services.node = lambda: self.here
        server = _services.serve("/say", callback, "p/srv/Say")
        self.addCleanup(server.close)

        def give(number):
            request = {"data": str(number)}
            self.here.backend.give(types.SimpleNamespace(request=request, answer=lambda _response: answered.append(number)))

        self.check_slow(callback, give)
        self.assertNotIn(1, answered)


class Frames(unittest.TestCase):
    def test_a_message_larger_than_a_frame_is_refused_and_the_next_one_is_sent(self):
        size = frames._FRAME_MAX - len('{"data":{"$":["B",0,1073741824]}}') + 1
        with self.assertRaisesRegex(ValueError, "a message of 1073741825 bytes is larger than 1073741824"):
            frames.packed({"data": bytes(size)})
        packed = frames.packed({"data": b"abc"})
        self.assertEqual(frames.read(io.BytesIO(packed)), ({"data": b"abc"}, len(packed) - 8))


class Events(unittest.TestCase):
    """Events of the helper that nobody has taken yet."""

    def setUp(self):
        self.callbacks = Callbacks()

    def give(self, numbers, size=0, kind="heard"):
        for number in numbers:
            self.callbacks.put({kind: number}, size)

    def taken(self, count):
        return [self.callbacks.get() for _ in range(count)]

    def check_dropped(self, said, dropped, kept):
        """The log has these counts, and the first of these many messages are gone."""
        texts = [f"the queue of received messages is full: {count} of the oldest messages are dropped" for count in said]
        found = self.taken(len(kept) + len(said))
        self.assertEqual([each["text"] for each in found if "say" in each], texts)
        self.assertEqual([each["heard"] for each in found if "heard" in each], kept)
        self.assertEqual(self.callbacks._dropped, dropped)

    def test_of_too_many_messages_the_oldest_are_dropped_and_the_log_says_so(self):
        self.give(range(10_003))
        self.check_dropped([1, 2], 3, list(range(3, 10_003)))
        self.give([7])
        self.assertEqual(self.taken(1), [{"heard": 7}])

    def test_of_too_many_bytes_the_oldest_messages_are_dropped_and_the_newest_is_kept(self):
        half = 32 << 20
        self.give(range(3), half)
        self.check_dropped([1], 1, [1, 2])
        self.give([3], 2 * half + 1)
        self.assertEqual(self.taken(1), [{"heard": 3}])

    def test_what_a_script_has_asked_for_is_never_dropped_and_comes_in_its_order(self):
        self.give([1], kind="response")
        self.give(range(10_001), kind="request")
        self.give(range(10_001), kind="failed")
        self.callbacks.put(None)
        found = self.taken(20_004)
        self.assertEqual([found[0], *found[-2:]], [{"response": 1}, {"failed": 10_000}, None])
        self.assertEqual([each["request"] for each in found[:-1] if "request" in each], list(range(1, 10_001)))


class Participants(unittest.TestCase):
    def test_of_too_many_participants_the_one_silent_for_longest_is_forgotten(self):
        # No domain has this number, so nothing is listened to.
        liveness = Liveness(-1)
        places = lambda number: (("127.0.0.1", number),)  # noqa: E731
        for number in range(1000):
            liveness._note(number, places(number))
        liveness._note(0, places(0))
        silent = liveness._participants[1]
        silent._ask()
        liveness._note(1000, places(1000))
        self.assertEqual((len(liveness._participants), list(liveness._participants)[:2]), (1000, [2, 3]))
        self.assertEqual([each.fileno() for each in silent._sockets], [-1])
        self.assertFalse(liveness.has_ended(1))
        liveness._note(1, places(1))
        self.assertIn(1, liveness._participants)


class Results(unittest.TestCase):
    def goal(self, number, begin, answers=None):
        """A request to begin a goal, or for its result, and where its answer goes."""
        goal_id = {"uuid": number.to_bytes(16, "big")}
        answers = [] if answers is None else answers
        request = types.SimpleNamespace(request={"goal_id": goal_id, **({"goal": {}} if begin else {})}, answer=answers.append)
        (self.server._take_goal if begin else self.server._take_result)(request)
        return answers

    def serve(self, close=lambda: None):
        """Offers an action whose goals end at once with their numbers."""
        part = types.SimpleNamespace(close=close, publish=lambda _message: None)
        backend = types.SimpleNamespace(publisher=lambda *_about: part, service=lambda *_about: part)

        def asked(goal):
            goal.accept(lambda: True)
            goal.finish(SUCCEEDED, {"number": int.from_bytes(goal.goal_id, "big")})

        self.server = ActionServer(backend, "/count", "p/action/Count", asked)
        self.addCleanup(self.server.close)

    def test_a_server_that_closes_lets_clients_have_the_last_results(self):
        done = []
        self.serve(lambda: done.append("closed"))
        self.goal(1, True)
        with unittest.mock.patch.object(_native_actions, "_TAKEN_S", 3600):
            closing = threading.Thread(target=self.server.close)
            closing.start()
            while self.server._open:
                pass
            self.goal(1, False, done)
            closing.join()
        self.assertEqual(done, [{"status": SUCCEEDED, "result": {"number": 1}}] + 5 * ["closed"])

    def test_of_too_many_ended_goals_the_result_of_the_oldest_is_forgotten(self):
        self.serve()
        for number in range(1, 1002):
            self.goal(number, True)
        self.assertEqual(self.goal(1, False), [{"status": SUCCEEDED, "result": {"number": 1}}])
        self.goal(1002, True)
        found = [self.goal(number, False) for number in (1, 2, 1002)]
        kept = [[{"status": SUCCEEDED, "result": {"number": number}}] for number in (2, 1002)]
        self.assertEqual(found, [[{"status": 0, "result": {}}], *kept])


class Users(unittest.TestCase):
    def test_so_many_users_of_a_type_are_asked_for_it(self):
        asked = []

        def client(name, _type):
            asked.append(name)
            raise RosError("it is gone")

        users = [["p/msg/New", "hash", f"/user{number}"] for number in range(4)]
        descriptions = Descriptions(types.SimpleNamespace(client=client), lambda _question, **_more: users, print)
        with self.assertRaises(UnknownType) as caught:
            descriptions.complete("p/msg/New", "there is no type p/msg/New")
        self.assertEqual(asked, [f"/user{number}/get_type_description" for number in range(3)])
        said = "; ".join(f"/user{number}: it is gone" for number in range(3))
        self.assertEqual(str(caught.exception), f"there is no type p/msg/New. Its users did not help: {said}")


if __name__ == "__main__":
    unittest.main()
