# Makes this interpreter the bridge to ROS 2: loads the extension as rafcon._native, whose package has the bridge.
import os
import sys


def become_bridge():
    from importlib.machinery import ExtensionFileLoader
    from importlib.util import module_from_spec, spec_from_file_location

    file = os.environ.pop("RAFCON_EXTENSION_FILE")
    try:
        loader = ExtensionFileLoader("rafcon._native", file)
        native = module_from_spec(spec_from_file_location("rafcon._native", file, loader=loader))
        loader.exec_module(native)
    except ImportError as error:
        sys.exit("%s cannot be loaded by %s: %s" % (file, sys.executable, error))
    sys.modules["rafcon._native"] = native
    native.serve_package()
    from rafcon.ros.bridge import main

    return main()


sys.exit(become_bridge())
