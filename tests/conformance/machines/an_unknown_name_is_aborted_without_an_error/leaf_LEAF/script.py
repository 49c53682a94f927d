def execute(self, inputs, outputs, gvm):
    return 'unheard of'
