"""Adds to a shared number. Between reading and writing nobody else may write: that is what the lock is for."""


def execute(self, inputs, outputs, gvm):
    for _ in range(inputs["apples"]):
        key = gvm.lock_variable("in the basket", block=True)
        count = gvm.get_locked_variable("in the basket", key)
        gvm.set_locked_variable("in the basket", key, count + 1)
        gvm.unlock_variable("in the basket", key)
    return "success"
