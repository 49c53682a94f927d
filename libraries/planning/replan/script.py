from rafcon import planning


def execute(self, inputs, outputs, gvm):
    return planning.replan(self, inputs, outputs)
