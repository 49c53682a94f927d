"""Pictures in all directions; what lies here is seen."""


def execute(self, inputs, outputs, gvm):
    if self.preemptive_wait(1.5 * gvm.get_variable("time_scale")):
        return "preempted"
    hidden = gvm.get_variable("hidden")
    outputs["things"] = [thing for thing, place in hidden.items() if place == inputs["waypoint"]]
    return "success"
