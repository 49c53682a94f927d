"""Picks a thing up. Of the mug on the ridge nobody knows that it slips."""


def execute(self, inputs, outputs, gvm):
    changes = dict(gvm.get_variable("rover_changes", default={}))
    thing, place = inputs["thing"], inputs["place"]
    changes[f"(at {thing} {place})"] = False
    slips = thing == "mug" and place == "ridge"
    if slips:
        changes["(at mug crater)"] = True
    else:
        changes["(hand-empty)"] = False
        changes[f"(holding {thing})"] = True
    gvm.set_variable("rover_changes", changes)
    if slips:
        raise RuntimeError("the mug slips and rolls into the crater")
    return "success"
