from rafcon import dialog

ANSWERS = ("again", "done", "give up")


def execute(self, inputs, outputs, gvm):
    pressed = dialog.ask(f"{inputs['step']} has failed.", ("Try again", "It is done", "Give up"), default=2)
    return ANSWERS[pressed.button]
