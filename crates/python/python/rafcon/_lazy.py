"""Submodules imported on first access, so that ``import rafcon`` gives access to all of them."""

import importlib


def submodules(package):
    """``__getattr__`` for a package that imports its modules and packages by name."""

    def find(name):
        if not name.startswith("_"):
            try:
                return importlib.import_module(f"{package}.{name}")
            except ModuleNotFoundError as error:
                if error.name != f"{package}.{name}":
                    raise
        raise AttributeError(f"module '{package}' has no attribute '{name}'")

    return find
