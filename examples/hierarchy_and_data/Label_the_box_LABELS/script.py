"""Puts together what the loop has collected."""


def execute(self, inputs, outputs, gvm):
    outputs["label"] = f"{inputs['count']} parts, {inputs['weight_g'] / 1000:.2f} kg"
    self.logger.info("the label says: %s", outputs["label"])
    return "success"
