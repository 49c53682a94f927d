"""Parts of a package that are imported when somebody first asks for them: ``import rafcon`` reaches all of it."""

import importlib


def submodules(package):
    """The ``__getattr__`` of a package: its modules and packages by name."""

    def find(name):
        if not name.startswith("_"):
            try:
                return importlib.import_module(f"{package}.{name}")
            except ModuleNotFoundError as error:
                if error.name != f"{package}.{name}":
                    raise
        raise AttributeError(f"module '{package}' has no attribute '{name}'")

    return find
