"""Puts battery and mug together."""


def execute(self, inputs, outputs, gvm):
    changes = dict(gvm.get_variable("rover_changes", default={}))
    changes[f"(assembled {inputs['battery']} {inputs['mug']})"] = True
    gvm.set_variable("rover_changes", changes)
    return "success"
