"""Thirty degrees further; a whole turn begins again at 0."""


def execute(self, inputs, outputs, gvm):
    outputs["bearing_deg"] = (inputs["bearing_deg"] + 30) % 360
    return "success"
