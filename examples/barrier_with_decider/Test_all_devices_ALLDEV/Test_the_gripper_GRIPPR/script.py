"""Fails: the exception ends this state by `aborted`, and the decider finds it by the state's name."""


def execute(self, inputs, outputs, gvm):
    raise ConnectionError("the gripper does not answer")
