"""It is assembled when it made the right sound."""


def execute(self, inputs, outputs, gvm):
    outputs["result"] = f"assembled with a {inputs['sound']}"
    return "assembled" if inputs["sound"] == "click" else "aborted"
