"""Lets messages arrive before their publishers go."""

import time

from rclpy.duration import Duration

#: Timeout (s) for acknowledgements when a node or a publisher closes. A newly matched subscriber acknowledges after the
#: next heartbeat, and the period of Fast DDS is 3 s.
_DELIVER_S = 3.5


def deliver(publishers):
    """Waits until the subscribers have what these publishers of ``rclpy`` sent: who publishes and ends would lose it."""
    end_s = time.monotonic() + _DELIVER_S
    for publisher in list(publishers):
        publisher.wait_for_all_acked(Duration(seconds=max(end_s - time.monotonic(), 0.0)))
