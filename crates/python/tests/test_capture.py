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
import traceback
import unittest
import warnings

import stage
from rafcon import _capture, _logging, _printed_errors
from rafcon.utils.log import RAFCONDeprecationWarning, get_logger


class Output(unittest.TestCase):
    def setUp(self):
        stage.native.clear([stage.described("execution", "A", "a", "A")])
        stage.enter(0)
        self.addCleanup(stage.leave)
        self.out = _capture.Writer("stdout", io.StringIO())
        # Else the garbage collector closes it during a later test, which flushes the text of that test.
        self.addCleanup(self.out.close)

    def lines(self):
        return [message for _path, _stream, _level, message in stage.native.sent]

    def test_a_line_is_sent_with_its_state(self):
        print("hello", file=self.out)
        self.assertEqual(stage.native.sent, [(0, "stdout", 20, "hello")])
        self.assertEqual(_capture.pending, {})

    def test_an_unfinished_line_waits_for_the_end_of_the_script(self):
        print("a", "b", sep="", end="", file=self.out)
        print("c\nd", end="", file=self.out)
        self.assertEqual(self.lines(), [])
        self.assertTrue(_capture.pending)
        _capture.flush_capture()
        self.assertEqual(self.lines(), ["abc\nd"])
        self.assertEqual(_capture.pending, {})

    def test_lines_of_one_write_are_one_entry(self):
        print("a\nb", file=self.out)
        self.out.write("c\nd\n")
        print("e", "f", sep="\n", file=self.out)
        self.assertEqual(self.lines(), ["a\nb", "c\nd", "e", "f"])

    def test_a_flush_sends_an_unfinished_line(self):
        for _ in range(2):
            print(".", end="", file=self.out, flush=True)
        self.assertEqual(self.lines(), [".", "."])
        self.out.flush()
        self.assertEqual(self.lines(), [".", "."])
        self.assertEqual(_capture.pending, {})

    def bar(self, *texts):
        """Everything that is sent of texts that are flushed one by one."""
        stage.native.sent.clear()
        for text in texts:
            print(text, end="", file=self.out, flush=True)
        before = self.lines()
        _capture.flush_capture()
        return before, self.lines()

    def test_a_progress_bar_is_one_entry(self):
        self.assertEqual(self.bar("\r 0%", "\r 50%", "\r100%", "\n"), (["100%"], ["100%"]))
        self.assertEqual(self.bar("10%\r", "20%\r"), ([], ["20%"]))
        self.assertEqual(self.bar("\r100%", "\r    \r"), ([], ["100%"]))
        self.assertEqual(self.bar("\r 50%", "\r    \r", "between\n", "\r100%"), (["between"], ["between", "100%"]))
        self.assertEqual(self.bar("before\n\r 50%", "\r100%"), (["before"], ["before", "100%"]))
        self.assertEqual(self.bar("a\r\n"), (["a"], ["a"]))

    def test_bars_below_each_other_are_one_entry(self):
        drawings = [text for step in range(100) for text in (f"\router {step}", f"\n\rinner {step}\x1b[A")]
        self.assertEqual(self.bar(*drawings), ([], ["inner 99"]))

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
        stage.native.sent.clear()
        self.out.write("xxx\n" * 50_000)
        self.assertEqual("\n".join(self.lines()) + "\n", "xxx\n" * 50_000)
        stage.native.sent.clear()
        self.out.write("x" * 200_000 + "\n")
        self.assertEqual(sum(map(len, self.lines())), 200_000)
        self.assertLessEqual(max(map(len, self.lines())), 64 * 1024)
        self.assertEqual(_capture.pending, {})

    def test_a_text_of_more_than_an_entry_holds_is_several_entries(self):
        most = 64 * 1024
        for length, pieces in ((most, [most]), (most + 1, [most, 1]), (2 * most + 1, [most, most, 1])):
            for ends in (("\n",), ("", "\n")):
                with self.subTest(length=length, ends=ends):
                    stage.native.sent.clear()
                    for number, end in enumerate(ends):
                        self.out.write(("x" * length if number == 0 else "") + end)
                    self.assertEqual(list(map(len, self.lines())), pieces)
        stage.native.sent.clear()
        self.out.write("x" * (most + 1))
        self.assertEqual(list(map(len, self.lines())), [most])
        self.out.write("after\n")
        self.assertEqual(self.lines()[1:], ["xafter"])

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


class Errors(unittest.TestCase):
    """What goes to ``sys.stderr``, where libraries write everything."""

    def setUp(self):
        stage.native.clear([stage.described("execution", "A", "a", "A")])
        stage.enter(0)
        self.addCleanup(stage.leave)
        before = (sys.stderr, sys.excepthook, threading.excepthook, sys.unraisablehook, traceback.print_exception)
        self.addCleanup(self.restore, *before)
        sys.stderr = _capture.Writer("stderr", io.StringIO())
        self.addCleanup(sys.stderr.close)
        _printed_errors.install()

    @staticmethod
    def restore(*before):
        sys.stderr, sys.excepthook, threading.excepthook, sys.unraisablehook, traceback.print_exception = before

    def test_it_is_no_error_by_itself(self):
        print("DEBUG robot.driver connected", file=sys.stderr)
        self.assertEqual(stage.native.sent, [(0, "stderr", 20, "DEBUG robot.driver connected")])

    def check(self, path, beginning, end):
        ((at, stream, level, message),) = stage.native.sent
        self.assertEqual((at, stream, level), (path, "stderr", 30))
        self.assertRegex(message, f"(?s)^{beginning}.*{end}$")

    def test_a_traceback_is_one_entry(self):
        try:
            try:
                1 / 0
            except ZeroDivisionError as error:
                raise KeyError("x") from error
        except KeyError:
            traceback.print_exc()
        self.check(0, "Traceback ", "The above exception was the direct cause.*KeyError: 'x'")

    def test_the_error_of_a_thread_is_one_entry(self):
        thread = threading.Thread(target=lambda: 1 / 0, name="mine")
        thread.start()
        thread.join()
        self.check(-1, "Exception in thread mine:\nTraceback ", "ZeroDivisionError: division by zero")

    def test_an_error_that_python_ignores_is_one_entry(self):
        class Bad:
            def __del__(self):
                raise ValueError("too late")

        Bad()
        self.check(0, "Exception ignored in: .*Traceback ", "ValueError: too late")

    def test_other_files_get_their_own(self):
        file = io.StringIO()
        try:
            1 / 0
        except ZeroDivisionError as error:
            traceback.print_exc(file=file)
            traceback.print_exception(type(error), error, error.__traceback__, None, file)
        self.assertEqual(file.getvalue().count("ZeroDivisionError: division by zero"), 2)
        self.assertEqual(stage.native.sent, [])


class Log(unittest.TestCase):
    def setUp(self):
        stage.native.clear([stage.described("execution", "A", "a", "A")])
        stage.enter(0)
        self.addCleanup(stage.leave)
        self.addCleanup(logging.captureWarnings, False)
        for name in ("rafcon", "py.warnings", None):
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

    def logs(self):
        """Logs with a logger of somebody else, and returns level and text of all entries."""
        robot = logging.getLogger("robot.driver")
        robot.debug("d")
        robot.info("i %d", 1)
        logging.warning("of the root")
        robot.error("e")
        self.assertEqual({entry[:2] for entry in stage.native.sent}, {(0, "logger")})
        return [entry[2:] for entry in stage.native.sent]

    BASIC = [(20, "robot.driver: i 1"), (30, "of the root"), (40, "robot.driver: e")]

    def test_every_logger_is_heard(self):
        _logging.install()
        self.assertEqual(self.logs(), self.BASIC)

    def print_to_us(self):
        self.addCleanup(setattr, sys, "stderr", sys.stderr)
        sys.stderr = _capture.Writer("stderr", io.StringIO())
        self.addCleanup(sys.stderr.close)

    def test_what_basic_config_prints_comes_once_and_with_its_level(self):
        self.print_to_us()
        _logging.install()
        logging.basicConfig(level=logging.DEBUG, format="%(asctime)s %(message)s")
        self.assertEqual(self.logs(), [(10, "robot.driver: d"), *self.BASIC])

    def test_a_handler_for_the_terminal_decides(self):
        self.print_to_us()
        _logging.install()
        handler = logging.StreamHandler()
        handler.setLevel(logging.ERROR)
        logging.basicConfig(level=logging.DEBUG, handlers=[handler])
        self.assertEqual(self.logs(), [(40, "robot.driver: e")])

    def test_a_file_beside_gets_its_own(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        path = pathlib.Path(folder.name) / "log"
        _logging.install()
        logging.basicConfig(filename=path, level=logging.INFO, format="%(levelname)s %(message)s")
        self.assertEqual(self.logs(), self.BASIC)
        logging.root.handlers[0].close()
        self.assertEqual(path.read_text(), "INFO i 1\nWARNING of the root\nERROR e\n")

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
