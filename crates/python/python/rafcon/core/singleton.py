"""Running objects, one of each per process."""

import argparse
import threading

from rafcon.core.execution.execution_engine import ExecutionEngine
from rafcon.core.global_variable_manager import global_variables
from rafcon.core.library_manager import LibraryManager
from rafcon.core.state_machine_manager import StateMachineManager

#: The variables shared by all states; scripts receive it as ``gvm``.
global_variable_manager = global_variables

#: The state machines of this process.
state_machine_manager = StateMachineManager()

#: Lookup of libraries.
library_manager = LibraryManager()

#: Pauses, resumes and stops the machine.
state_machine_execution_engine = ExecutionEngine(state_machine_manager)

#: For programs that add their own options to a command line; empty.
argument_parser = argparse.ArgumentParser(description="Start RAFCON")

#: The number of the signal that ends the process, if one does.
shut_down_signal = None

#: The thread that first imported this module.
thread_identifier = threading.get_ident()
