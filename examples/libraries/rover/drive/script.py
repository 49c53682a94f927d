"""Drives: the simulated rover is there at once."""


def execute(self, inputs, outputs, gvm):
    changes = dict(gvm.get_variable("rover_changes", default={}))
    changes[f"(rover-at {inputs['from']})"] = False
    changes[f"(rover-at {inputs['to']})"] = True
    gvm.set_variable("rover_changes", changes)
    return "success"
