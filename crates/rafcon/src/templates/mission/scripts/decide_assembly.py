"""Both arms are done: does the battery stand straight?"""

STRAIGHT_DEG = 2.0


def execute(self, inputs, outputs, gvm):
    return "assembled" if inputs["askew_deg"] < STRAIGHT_DEG else "askew"
