"""The parts of a state machine: states, their elements, the running objects and the variables."""
