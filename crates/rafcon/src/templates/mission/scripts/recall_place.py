"""Where the survey has seen the thing."""


def execute(self, inputs, outputs, gvm):
    outputs["x_m"], outputs["y_m"] = gvm.get_variable("found")[inputs["thing"]]
    return "success"
