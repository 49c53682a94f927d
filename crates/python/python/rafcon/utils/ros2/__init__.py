"""ROS 2 in scripts: a node that all states share, and handles whose waits end at preemption.

The first state creates the node and stores it, by reference, in the global variable
``rafcon_ros_node``. It also creates the dictionaries ``ros_publishers`` and ``ros_clients``, in
which the handles keep their objects for the next run. The ROS 2 packages (``rclpy``) are required.
"""

from rafcon._lazy import submodules

__getattr__ = submodules(__name__)
