"""Fails: the exception ends this state by `aborted`, and the decider finds it by the state's name."""


def execute(self, inputs, outputs, gvm):
    ask("open")
    return "success"


def ask(command):
    """At the other end of the cable nobody hears the command."""
    raise ConnectionError("the gripper does not answer")
