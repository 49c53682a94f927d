"""Questions about dictionaries."""


def check_if_dict_contains_object_reference_in_values(object_to_check, dict_to_check):
    """Whether one of the values is this very object."""
    return any(value is object_to_check for value in dict_to_check.values())
