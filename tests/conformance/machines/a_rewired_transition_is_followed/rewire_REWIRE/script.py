def execute(self, inputs, outputs, gvm):
    ours = self.parent
    ours.get_transition_for_outcome(self, self.outcomes[0]).to_state = "OTHER"
    return 0
