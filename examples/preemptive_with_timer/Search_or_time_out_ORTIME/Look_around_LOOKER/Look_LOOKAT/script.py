"""`preemptive_wait` ends at once when the state is preempted, and says so by returning True."""


def execute(self, inputs, outputs, gvm):
    if self.preemptive_wait(0.05):
        self.logger.info("preempted while looking to %d degrees", inputs["bearing_deg"])
        return "preempted"
    seen = inputs["bearing_deg"] == inputs["hidden_at_deg"]
    return "seen" if seen else "nothing here"
