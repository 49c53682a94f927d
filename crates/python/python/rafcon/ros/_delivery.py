"""Delivery of messages before their publishers close."""

import time

from rclpy.duration import Duration

#: Timeout (s) for acknowledgements when a node or a publisher closes. A newly matched subscriber acknowledges after the
#: next heartbeat, and the period of Fast DDS is 3 s.
_DELIVER_S = 3.5


def deliver(publishers):
    """Wait until subscribers have all messages of these ``rclpy`` publishers, at most 3.5 s.

    Without the wait, messages sent immediately before the end would be lost.
    """
    end_s = time.monotonic() + _DELIVER_S
    for publisher in list(publishers):
        publisher.wait_for_all_acked(Duration(seconds=max(end_s - time.monotonic(), 0.0)))
