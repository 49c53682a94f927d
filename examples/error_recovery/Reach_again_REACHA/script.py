"""The same list, written back to the same scoped variable."""


def execute(self, inputs, outputs, gvm):
    outputs["remedies"] = [*inputs["remedies"], "reached again"]
    return "success"
