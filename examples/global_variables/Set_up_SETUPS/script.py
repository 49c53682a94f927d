"""Global variables live as long as the run. They are copied in and out unless they are set by reference."""


def execute(self, inputs, outputs, gvm):
    gvm.set_variable("apples on the left tree", 30)
    gvm.set_variable("apples on the right tree", 12)
    gvm.set_variable("in the basket", 0, data_type=int)
    gvm.set_variable("logbook", ["the basket is empty"], per_reference=True)
    return "success"
