"""A variable that was set by reference is the same object for everybody."""


def execute(self, inputs, outputs, gvm):
    total = gvm.get_variable("in the basket")
    gvm.get_variable("logbook").append(f"{total} apples are in the basket")
    outputs["total"] = total
    outputs["log"] = gvm.get_variable("logbook")
    return "success"
