"""``rafcon.ros`` where there is no network at all, not even the loopback: every call ends, with words."""

import shutil
import subprocess
import sys
import unittest

from peers import PACKAGE

PROGRAM = f"""
import sys
sys.path.insert(0, {str(PACKAGE)!r})
from rafcon import ros

ros.publish("/alone/topic", "x", "std_msgs/String", wait=0.1)
print(ros.latest("/alone/topic", "std_msgs/String", timeout=0.1))
for wait in (
    lambda: ros.call("/alone/service", None, "std_srvs/Trigger", find=0.1),
    lambda: ros.wait_for("/alone/other", "std_msgs/String", timeout=0.1),
    lambda: ros.param_get("/alone/node", "speed", find=0.1),
):
    try:
        wait()
    except ros.RosError as error:
        print(type(error).__name__)
ros.close()
"""


def can_be_alone():
    """Whether the system lets users make networks of their own."""
    return shutil.which("unshare") and subprocess.run(["unshare", "-rn", "true"], check=False, capture_output=True).returncode == 0


@unittest.skipUnless(can_be_alone(), "no network of its own is possible here")
class Alone(unittest.TestCase):
    def test_every_call_ends(self):
        run = subprocess.run(["unshare", "-rn", sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=False)
        self.assertEqual(run.stdout.split(), ["None", "NoServer", "TimedOut", "NoServer"], run.stderr)


if __name__ == "__main__":
    unittest.main()
