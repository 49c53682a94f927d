"""Functions on dictionaries."""


def check_if_dict_contains_object_reference_in_values(object_to_check, dict_to_check):
    """True if one of the values is this object itself."""
    return any(value is object_to_check for value in dict_to_check.values())
