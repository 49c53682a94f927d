"""Says something in the log. `subject` is put where the message has {subject}."""


def execute(self, inputs, outputs, gvm):
    self.logger.info(inputs["message"].format(subject=inputs["subject"]))
    return "success"
