"""What scripts print and log: whose it is, when it is sent."""

import io
import json
import logging
import os
import pathlib
import subprocess
import sys
import tempfile
import threading
import unittest
import warnings

import stage
from rafcon import _capture, _logging
from rafcon.utils.log import RAFCONDeprecationWarning, get_logger


class Output(unittest.TestCase):
    def setUp(self):
        stage.native.clear([stage.described("execution", "A", "a", "A")])
        stage.enter(0)
        self.addCleanup(stage.leave)
        self.out = _capture.Writer("stdout", io.StringIO())

    def lines(self):
        return [message for _path, _stream, _level, message in stage.native.sent]

    def test_a_line_is_sent_with_its_state(self):
        print("hello", file=self.out)
        self.assertEqual(stage.native.sent, [(0, "stdout", 20, "hello")])
        self.assertEqual(_capture.pending, {})

    def test_an_unfinished_line_waits_for_the_end_of_the_script(self):
        print("a", "b", sep="", end="", file=self.out)
        print("c\nd", end="", file=self.out)
        self.assertEqual(self.lines(), ["abc"])
        self.assertTrue(_capture.pending)
        _capture.flush_capture()
        self.assertEqual(self.lines(), ["abc", "d"])
        self.assertEqual(_capture.pending, {})

    def test_threads_do_not_share_a_line(self):
        self.out.write("mine ")
        other = threading.Thread(target=self.out.write, args=("theirs\n",))
        other.start()
        other.join()
        self.out.write("still mine\n")
        self.assertEqual([entry[0::3] for entry in stage.native.sent], [(-1, "theirs"), (0, "mine still mine")])

    def test_everybody_is_flushed_at_the_end(self):
        other = threading.Thread(target=self.out.write, args=("theirs",))
        other.start()
        other.join()
        _capture.flush_capture()
        self.assertEqual(self.lines(), [])
        _capture.flush_all()
        self.assertEqual(self.lines(), ["theirs"])

    def test_a_very_long_line_is_cut(self):
        self.out.write("x" * 200_000)
        self.out.write("\n")
        self.assertEqual(sum(map(len, self.lines())), 200_000)
        self.assertLessEqual(max(map(len, self.lines())), 64 * 1024)
        self.assertEqual(_capture.pending, {})

    def test_bytes_and_odd_texts(self):
        self.out.buffer.write(b"caf\xc3\xa9 \xff\r\n")
        self.out.write("\ud800\n")
        self.assertEqual(self.lines(), ["café \\xff", "\\ud800"])
        with self.assertRaises(TypeError):
            self.out.write(b"bytes")

    def test_a_forked_child_prints_to_the_real_stream(self):
        self.out.released()
        self.out.write("child\n")
        self.assertEqual(self.lines(), [])


class Log(unittest.TestCase):
    def setUp(self):
        stage.native.clear([stage.described("execution", "A", "a", "A")])
        stage.enter(0)
        self.addCleanup(stage.leave)
        self.addCleanup(logging.captureWarnings, False)
        for name in ("rafcon", "py.warnings"):
            logger = logging.getLogger(name)
            self.addCleanup(self.restore, logger, logger.level, logger.propagate, list(logger.handlers))
            logger.handlers.clear()

    @staticmethod
    def restore(logger, level, propagate, handlers):
        logger.setLevel(level)
        logger.propagate = propagate
        logger.handlers[:] = handlers

    def configured(self, configuration):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        path = pathlib.Path(folder.name) / "logging.json"
        path.write_text(configuration if isinstance(configuration, str) else json.dumps(configuration))
        os.environ["RAFCON_LOGGING_CONF"] = str(path)
        self.addCleanup(os.environ.pop, "RAFCON_LOGGING_CONF")

    def test_every_level_is_sent(self):
        _logging.install()
        logger = stage.native.state_object(0).logger
        logger.verbose("v %d", 1)
        logger.debug("d")
        logger.error("e")
        self.assertEqual(stage.native.sent, [(0, "logger", 5, "v 1"), (0, "logger", 10, "d"), (0, "logger", 40, "e")])

    def test_an_exception_comes_with_its_traceback(self):
        _logging.install()
        try:
            1 / 0
        except ZeroDivisionError:
            get_logger("a").exception("failed")
        self.assertRegex(stage.native.sent[0][3], r"(?s)^failed\nTraceback .*ZeroDivisionError: division by zero$")

    def test_warnings_are_logged(self):
        _logging.install()
        warnings.warn("old", RAFCONDeprecationWarning, stacklevel=1)
        ((path, stream, level, message),) = stage.native.sent
        self.assertEqual((path, stream, level), (0, "logger", 30))
        self.assertIn("RAFCONDeprecationWarning: old", message)

    def test_a_configuration_of_the_user_holds(self):
        self.configured({
            "version": 1,
            "disable_existing_loggers": False,
            "handlers": {"console": {"class": "logging.StreamHandler"}},
            "loggers": {"rafcon": {"level": "WARNING", "handlers": ["console"]}},
        })  # fmt: skip
        _logging.install()
        get_logger("a").info("too low")
        get_logger("a").warning("high enough")
        self.assertEqual([entry[3] for entry in stage.native.sent], ["high enough"])
        self.assertEqual(len(logging.getLogger("rafcon").handlers), 1)

    def test_a_broken_configuration_is_said_and_left_out(self):
        self.configured("{")
        _logging.install()
        self.assertIn("RAFCON_LOGGING_CONF", stage.native.sent[0][3])


FORKING = """
import os, sys
sys.path.insert(0, {tests!r})
import stage
from rafcon import _runtime
stage.native.clear([])
_runtime.install_capture()
print("parent, unfinished", end="")
child = os.fork()
if child == 0:
    print("child")
    _runtime.global_variable_manager.set_variable("a", 1)
    import logging
    logging.getLogger("rafcon.x").warning("logged")
    sys.stdout.flush()
    os._exit(0)
os.waitpid(child, 0)
_runtime.flush_all()
sys.__stdout__.write(repr(stage.native.sent))
"""


class Fork(unittest.TestCase):
    def test_a_child_has_nothing_to_do_with_the_machine(self):
        script = FORKING.format(tests=str(pathlib.Path(__file__).parent))
        done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.stderr, "logged\n")
        self.assertEqual(done.stdout, "child\n[(-1, 'stdout', 20, 'parent, unfinished')]")


if __name__ == "__main__":
    unittest.main()
