def execute(self, inputs, outputs, gvm):
    outputs.update(number=1, real=0.5, text='é', truth=True, items=[1, [2]], table={'a': {'b': 1}}, pair=(1, 'x'))
    return 0

