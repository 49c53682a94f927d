"""RAFCON: hierarchical, concurrent state machines for robot tasks.

In a running state machine this package is what scripts see: ``self`` is a state of
:mod:`rafcon.core.states`, ``gvm`` the manager of :mod:`rafcon.core.global_variable_manager`, and the running
objects are in :mod:`rafcon.core.singleton`.

In a plain interpreter it can be imported too; type checkers, editors and tests of script code then find every name.
There is no machine behind it there: start one with ``rafcon run PATH``.
"""

__version__ = "0.1.0"
