"""Camera and laser are done: is there something to fetch?"""


def execute(self, inputs, outputs, gvm):
    outputs["things"] = inputs["things"]
    return "found" if inputs["things"] else "nothing"
