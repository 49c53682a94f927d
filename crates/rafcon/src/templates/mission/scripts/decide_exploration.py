"""Survey, map and radio have ended: was enough seen to go on?"""


def execute(self, inputs, outputs, gvm):
    known = gvm.get_variable("found")
    self.logger.info("explored: %d scans, found %s", inputs["scans"], ", ".join(sorted(known)) or "nothing")
    return "explored" if len(known) == len(gvm.get_variable("hidden")) else "not enough"
