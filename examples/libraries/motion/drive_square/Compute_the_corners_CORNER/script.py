"""The corners of a square that begins where the robot is."""


def execute(self, inputs, outputs, gvm):
    x, y = gvm.get_variable("position", default=(0.0, 0.0))
    outputs["left_m"], outputs["right_m"] = x, x + inputs["side_m"]
    outputs["low_m"], outputs["high_m"] = y, y + inputs["side_m"]
    return "success"
