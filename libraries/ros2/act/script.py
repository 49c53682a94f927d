from rafcon import ros


def execute(self, inputs, outputs, gvm):
    ended = ros.action(
        inputs["action"],
        inputs["goal"],
        inputs["type"] or None,
        timeout=inputs["timeout"] or None,
        cancel_wait_s=inputs["cancel_wait_s"],
    )
    outputs["result"] = ended.result and ended.result.as_dict()
    outputs["feedback"] = ended.feedback and ended.feedback.as_dict()
    outputs["why"] = ended.why
    return ended.outcome
