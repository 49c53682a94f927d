"""Compares two inputs. Outcomes may be returned by name or by id."""


def execute(self, inputs, outputs, gvm):
    missing = inputs["wanted"] - inputs["count"]
    self.logger.info("%d of %d parts are in the box", inputs["count"], inputs["wanted"])
    return "full" if missing <= 0 else "room left"
