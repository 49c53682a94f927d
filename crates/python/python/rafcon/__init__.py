"""RAFCON: hierarchical, concurrent state machines for robot tasks.

In a running state machine this package is what scripts see: ``self`` is a state of
:mod:`rafcon.core.states`, ``gvm`` the manager of :mod:`rafcon.core.global_variable_manager`, and the running
objects are in :mod:`rafcon.core.singleton`.

In a plain interpreter the same classes build machines, load and save them (:mod:`rafcon.core.storage.storage`), and
run them where they were built (``state_machine_execution_engine`` of :mod:`rafcon.core.singleton`). Without the
compiled module, type checkers, editors and tests of script code still find every name.
"""

from rafcon._lazy import submodules

__version__ = "0.1.0"

__getattr__ = submodules(__name__)
