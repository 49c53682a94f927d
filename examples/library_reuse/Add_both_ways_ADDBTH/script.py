"""An ordinary state between libraries: they connect like all others."""


def execute(self, inputs, outputs, gvm):
    outputs["distance_m"] = inputs["small_m"] + inputs["large_m"]
    return "success"
