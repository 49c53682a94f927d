"""Four instances of one library have brought four distances."""


def execute(self, inputs, outputs, gvm):
    outputs["distance_m"] = sum(inputs.values())
    return "success"
