"""What a script raises is the error that its machine sees."""


class Jammed(Exception):
    """The plug stands askew."""


def execute(self, inputs, outputs, gvm):
    if inputs["attempt"] == 1:
        raise Jammed("the plug stands askew")
    if inputs["attempt"] == 2:
        raise TimeoutError("the arm did not reach the socket")
    return "success"
