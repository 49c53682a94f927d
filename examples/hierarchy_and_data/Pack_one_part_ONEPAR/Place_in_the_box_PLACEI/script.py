"""Outputs travel along data flows: here to the outputs of the surrounding hierarchy."""


def execute(self, inputs, outputs, gvm):
    outputs["count"] = inputs["count"] + 1
    outputs["weight_g"] = inputs["weight_g"] + inputs["part_g"]
    return "success"
