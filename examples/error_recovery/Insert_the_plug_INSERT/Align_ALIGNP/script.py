"""Every attempt counts, also one that fails: outputs are kept when a script raises."""


def execute(self, inputs, outputs, gvm):
    outputs["attempt"] = inputs["attempt"] + 1
    return "success"
