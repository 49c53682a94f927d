"""Adds the scan to the map."""


def execute(self, inputs, outputs, gvm):
    outputs["scans"] = inputs["scans"] + 1
    return "success"
