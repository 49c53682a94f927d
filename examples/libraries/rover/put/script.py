"""Puts down what the gripper holds."""


def execute(self, inputs, outputs, gvm):
    changes = dict(gvm.get_variable("rover_changes", default={}))
    changes[f"(holding {inputs['thing']})"] = False
    changes["(hand-empty)"] = True
    changes[f"(at {inputs['thing']} {inputs['place']})"] = True
    gvm.set_variable("rover_changes", changes)
    return "success"
