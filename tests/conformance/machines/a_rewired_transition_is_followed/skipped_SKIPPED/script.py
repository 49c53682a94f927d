def execute(self, inputs, outputs, gvm):
    raise ValueError('broken')
