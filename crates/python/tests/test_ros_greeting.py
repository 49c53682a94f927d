"""How participants of DDS are asked where they are, with sockets in the place of participants."""

import pathlib
import socket
import sys
import threading
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "python"))

from rafcon.ros._greeting import announcement, good_bye, greet
from rafcon.ros._liveness import announced

#: A domain that nobody uses, and the port of its first process.
DOMAIN = 97
FIRST = 7410 + 250 * DOMAIN
OWN, OTHER = b"own participant"[:12], b"another one."


class Participant:
    """Answers who announces itself, and keeps all else that it hears."""

    def __init__(self, test, key, number):
        self.key = key
        self.heard = []
        self.has_heard = threading.Event()
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", FIRST + 2 * number))
        self.announcement = announcement(key, self.socket.getsockname(), 20)
        self.thread = threading.Thread(target=self.listen)
        self.thread.start()
        test.addCleanup(self.end)

    def listen(self):
        known = set()
        while True:
            content = self.socket.recv(65536)
            if content == b"end":
                return
            found = announced(content)
            if found is None or found[0] in (OWN, OTHER):
                self.heard.append(content)
                self.has_heard.set()
            elif found[0] not in known:
                known.add(found[0])
                self.socket.sendto(self.announcement, found[1][0])

    def end(self):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
            other.sendto(b"end", self.socket.getsockname())
        self.thread.join()
        self.socket.close()


class Greeting(unittest.TestCase):
    def test_answers_are_noted_and_passed_on_to_the_participant_of_this_process(self):
        own, other = Participant(self, OWN, 0), Participant(self, OTHER, 3)
        noted = {}
        greet(DOMAIN, OWN, noted.__setitem__, own.has_heard.is_set)
        self.assertEqual(noted, {OTHER: (other.socket.getsockname(),)})
        self.assertEqual(own.heard[0], other.announcement)

    def test_it_says_good_bye(self):
        own, other = Participant(self, OWN, 0), Participant(self, OTHER, 3)
        greet(DOMAIN, OWN, lambda _key, _places: None, own.has_heard.is_set)
        self.assertTrue(other.has_heard.wait(60))
        prefix = other.heard[0][8:20]
        self.assertEqual(other.heard[0], good_bye(prefix))

    def test_what_is_announced_is_read(self):
        self.assertEqual(announced(announcement(OTHER, ("192.168.1.2", 4711), 2)), (OTHER, (("192.168.1.2", 4711),)))
        self.assertIsNone(announced(good_bye(OTHER)))


if __name__ == "__main__":
    unittest.main()
