"""Names of the files of a state machine."""
