"""Looks all around to find out where the robot is; the error that led here may say why."""


def execute(self, inputs, outputs, gvm):
    reason = inputs.get("error") or "the landmarks do not match"
    self.logger.info("relocalise: %s", reason)
    if self.preemptive_wait(2.0 * gvm.get_variable("time_scale")):
        return "preempted"
    return "success"
