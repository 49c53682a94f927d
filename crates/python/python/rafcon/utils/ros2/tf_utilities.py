"""Conversion of ROS 2 transforms to plain numbers."""


def tf_from_stamped(tf_stamped):
    """Position ``[x, y, z]`` and orientation ``[x, y, z, w]`` of a ``TransformStamped``."""
    position, orientation = tf_stamped.transform.translation, tf_stamped.transform.rotation
    return [position.x, position.y, position.z], [orientation.x, orientation.y, orientation.z, orientation.w]
