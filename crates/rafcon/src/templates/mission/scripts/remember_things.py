"""Where things lie, for those who fetch them."""


def execute(self, inputs, outputs, gvm):
    found = gvm.get_variable("found")
    for thing in inputs["things"]:
        found[thing] = (inputs["x_m"], inputs["y_m"])
        self.logger.info("found the %s at waypoint %d", thing, inputs["waypoint"])
    gvm.set_variable("found", found)
    return "success"
