# Makes this interpreter a runner: loads the extension as rafcon._native and hands over.
import os
import sys


def refuse(reason):
    sys.stderr.write(reason + "\n")
    sys.stderr.flush()
    os._exit(78)


def become_runner():
    name = "%s %d.%d (%s)" % (sys.implementation.name, sys.version_info[0], sys.version_info[1], sys.executable)
    if sys.implementation.name != "cpython" or sys.version_info < (3, 9):
        refuse("rafcon needs CPython 3.9 or newer, this is " + name)
    if "t" in getattr(sys, "abiflags", ""):
        refuse("rafcon needs a Python with the global interpreter lock, this is a free-threaded build: " + name)
    import faulthandler
    from importlib.machinery import ExtensionFileLoader
    from importlib.util import module_from_spec, spec_from_file_location

    control = int(os.environ.pop("RAFCON_CONTROL_FD"))
    os.set_inheritable(control, False)
    file = os.environ.pop("RAFCON_EXTENSION_FILE")
    try:
        loader = ExtensionFileLoader("rafcon._native", file)
        native = module_from_spec(spec_from_file_location("rafcon._native", file, loader=loader))
        loader.exec_module(native)
    except ImportError as error:
        refuse("%s cannot be loaded by %s: %s" % (file, name, error))
    sys.modules["rafcon._native"] = native
    faulthandler.enable(all_threads=False)
    return native.main(control)


sys.exit(become_runner())
