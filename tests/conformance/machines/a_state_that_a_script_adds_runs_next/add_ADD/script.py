def execute(self, inputs, outputs, gvm):
    from rafcon.core.states.execution_state import ExecutionState
    new = ExecutionState("new", "NEW")
    head = "def execute(self, inputs, outputs, gvm):"
    new.script_text = head + "\n    self.logger.info('%s %s', self.name, inputs)\n    return 0\n"

    ours = self.parent
    new.add_input_data_port("word", str, "default")
    ours.add_state(new)
    ours.transitions[ours.get_transition_for_outcome(self, self.outcomes[0]).transition_id].to_state = "NEW"
    ours.add_transition("NEW", 0, "LAST", None)
    self.logger.info("%s", sorted(ours.states))
    return 0
