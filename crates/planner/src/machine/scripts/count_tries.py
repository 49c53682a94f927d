def execute(self, inputs, outputs, gvm):
    outputs["tries"] = inputs["tries"] + 1
    return "again" if outputs["tries"] <= inputs["retries"] else "over"
