"""The built file itself: one for every interpreter, linked with none."""

import struct
import subprocess
import sys
import tempfile
import unittest

from support import EXTENSION, container, run, save, script, sequence

_DYNAMIC, _NEEDED, _STRTAB = 2, 1, 5


def needed_libraries(path):
    """The names of the libraries that a 64-bit little-endian ELF file asks the loader for."""
    with open(path, "rb") as file:
        data = file.read()
    assert data[:6] == b"\x7fELF\x02\x01", "a 64-bit little-endian ELF file"
    table, size, count = struct.unpack_from("<Q", data, 32)[0], *struct.unpack_from("<HH", data, 54)
    segments = [struct.unpack_from("<IIQQQQ", data, table + number * size) for number in range(count)]
    dynamic = next(segment for segment in segments if segment[0] == _DYNAMIC)
    entries = [struct.unpack_from("<QQ", data, dynamic[2] + at) for at in range(0, dynamic[5], 16)]
    strings = _offset(segments, next(value for tag, value in entries if tag == _STRTAB))
    names = [strings + value for tag, value in entries if tag == _NEEDED]
    return [data[name : data.index(b"\0", name)].decode() for name in names]


def _offset(segments, address):
    for kind, _flags, offset, start, _physical, length in segments:
        if kind == 1 and start <= address < start + length:
            return offset + address - start
    raise ValueError("no segment holds the address %d" % address)


class Extension(unittest.TestCase):
    def test_it_links_no_python(self):
        libraries = needed_libraries(EXTENSION)
        self.assertIn("libc.so.6", libraries)
        self.assertEqual([name for name in libraries if "python" in name], [])

    def test_it_can_be_imported_without_a_run(self):
        code = """
import importlib.machinery, importlib.util
loader = importlib.machinery.ExtensionFileLoader("rafcon._native", %r)
native = importlib.util.module_from_spec(importlib.util.spec_from_file_location("rafcon._native", loader=loader))
loader.exec_module(native)
print(native.VERSION == "0.1.0", native.current_path())
for ask in (native.machine, lambda: native.status(0), lambda: native.command("stop"), lambda: native.main(9999)):
    try:
        ask()
    except (RuntimeError, OSError) as error:
        print(error)
"""
        answer = subprocess.run([sys.executable, "-c", code % EXTENSION], capture_output=True, text=True)
        self.assertEqual(
            answer.stdout.splitlines(),
            ["True -1"] + ["no state machine runs in this process"] * 3 + ["[Errno 9] Bad file descriptor"],
            answer.stderr,
        )

    def test_a_program_that_a_script_starts_does_not_get_the_socket(self):
        text = """
import os, subprocess, sys
def execute(self, inputs, outputs, gvm):
    show = "import os; print(sorted(os.listdir('/proc/self/fd')))"
    print(subprocess.run([sys.executable, "-c", show], close_fds=False, capture_output=True, text=True).stdout)
    print(len([fd for fd in os.listdir("/proc/self/fd") if os.path.exists("/proc/self/fd/" + fd) and os.get_inheritable(int(fd))]))
    return 0
"""
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        result = run(save(folder.name, sequence(script(text))))
        self.assertEqual(result.logged("stdout")[-1], "3", result.logged())

    def test_a_module_body_may_run_once(self):
        for option, counts in (("True", ["1", "1", "1"]), ("False", ["1", "2", "3"])):
            with self.subTest(option), tempfile.TemporaryDirectory() as folder:
                self.check_counts(folder, option, counts)

    def check_counts(self, folder, option, counts):
        text = "count = 0\ndef execute(self, inputs, outputs, gvm):\n    global count\n    count += 1\n    print(count)\n    self.entries = getattr(self, 'entries', 0) + 1\n    return 0 if self.entries < 3 else 1\n"
        child = script(text, outcomes=("again", "enough"))
        root = container("hierarchy", [child], [(None, None, "A"), ("A", 0, "A"), ("A", 1, 0)])
        config = folder + "/config.yaml"
        with open(config, "w") as file:
            file.write("TYPE: SM_CONFIG\nSCRIPT_RECOMPILATION_ON_STATE_EXECUTION: %s\n" % option)
        result = run(save(folder + "/machine", root), config=config)
        self.assertEqual(result.logged("stdout"), counts)


if __name__ == "__main__":
    unittest.main()
