"""The result of the mission, whatever it is."""


def execute(self, inputs, outputs, gvm):
    outputs["fetched"] = gvm.get_variable("on the table")
    self.logger.info("fetched: %s", ", ".join(outputs["fetched"]) or "nothing")
    return "all" if len(outputs["fetched"]) == 2 else "not all"
