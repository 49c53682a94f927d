def execute(self, inputs, outputs, gvm):
    gvm.set_variable('speed', 3)
    return 0
