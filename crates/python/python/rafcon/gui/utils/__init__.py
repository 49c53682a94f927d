"""What scripts can use without a desktop."""


def wait_for_gui():
    """Nothing to wait for."""
