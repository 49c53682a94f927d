"""What a script receives is its own copy: it may change it freely."""


def execute(self, inputs, outputs, gvm):
    inputs["remedies"].append("turned the plug")
    outputs["remedies"] = inputs["remedies"]
    return "success"
