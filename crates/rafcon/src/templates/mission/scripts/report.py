"""What the mission has brought, however it went."""


def execute(self, inputs, outputs, gvm):
    fetched = gvm.get_variable("fetched")
    seen = list(gvm.get_variable("waypoints").values()).count("seen")
    outputs["fetched"] = fetched
    outputs["report"] = f"{seen} waypoints seen, fetched: {', '.join(fetched) or 'nothing'}"
    self.logger.info(outputs["report"])
    return "complete" if inputs["assembled"] else "incomplete"
