def execute(self, inputs, outputs, gvm):
    ends = {state_id: outcome.name for state_id, (_, outcome) in self.final_outcomes_dict.items()}
    missed = [state_id for state_id, outcome in inputs["wanted"].items() if ends.get(state_id) != outcome]
    return "aborted" if missed else "success"
