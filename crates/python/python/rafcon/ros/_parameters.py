"""Parameters of other nodes."""

from rafcon.ros._backend import RosError
from rafcon.ros._node import FIND_S, node
from rafcon.ros._services import call

#: The field of ``rcl_interfaces/msg/ParameterValue`` for each ``ParameterType``.
_FIELDS = {
    1: "bool_value",
    2: "integer_value",
    3: "double_value",
    4: "string_value",
    5: "byte_array_value",
    6: "bool_array_value",
    7: "integer_array_value",
    8: "double_array_value",
    9: "string_array_value",
}
_DOUBLE, _DOUBLES = 3, 8


class ParameterError(RosError):
    """A node lacks a parameter, or refuses a value."""


def param_get(node_name, name, timeout=5.0, find=FIND_S):
    """Value of a parameter of a node; for a list of names, a dictionary of values.

    Raises :class:`ParameterError` if the node lacks a parameter, also for a list.
    """
    names = [name] if isinstance(name, str) else list(name)
    response = _ask(node_name, "get_parameters", "GetParameters", {"names": names}, timeout, find)
    # A node that lacks one of them returns an empty list.
    values = [_python(value) for value in response["values"]] if len(response["values"]) == len(names) else [None] * len(names)
    missing = [each for each, value in zip(names, values) if value is None]
    if missing:
        raise ParameterError(f"the node {node().absolute(node_name)} does not have {' and '.join(missing)}, or not all of these names")
    return values[0] if isinstance(name, str) else dict(zip(names, values))


def param_set(node_name, name, value=None, timeout=5.0, find=FIND_S):
    """Set a parameter of a node, or several if ``name`` is a dictionary.

    An integer is converted for a ``double`` parameter. If the node refuses a value,
    :class:`ParameterError` has its reason. Other parameters of the request may be set already.
    """
    wanted = dict(name) if isinstance(name, dict) else {name: value}
    kinds = _ask(node_name, "get_parameter_types", "GetParameterTypes", {"names": list(wanted)}, timeout, find)["types"]
    kinds = dict(zip(wanted, kinds)) if len(kinds) == len(wanted) else {}
    parameters = [{"name": each, "value": _ros(each, content, kinds.get(each))} for each, content in wanted.items()]
    response = _ask(node_name, "set_parameters", "SetParameters", {"parameters": parameters}, timeout, find)
    for each, result in zip(wanted, response["results"]):
        if not result["successful"]:
            reason = result["reason"] or "it gives no reason"
            raise ParameterError(f"the node {node().absolute(node_name)} does not take {each} = {wanted[each]!r}: {reason}")


def _ask(node_name, service, type_name, request, timeout, find):
    return call(f"{node().absolute(node_name)}/{service}", request, f"rcl_interfaces/srv/{type_name}", timeout, find)


def _python(value):
    field = _FIELDS.get(value["type"])
    if field is None:
        return None
    found = value[field]
    return found if isinstance(found, (bool, int, float, str, bytes)) else list(found)


def _ros(name, value, kind):
    if kind == _DOUBLE and isinstance(value, int) and not isinstance(value, bool):
        value = float(value)
    if kind == _DOUBLES and isinstance(value, (list, tuple)):
        value = [float(each) for each in value]
    number = _kind(name, value)
    return {"type": number, _FIELDS[number]: list(value) if isinstance(value, tuple) else value}


def _kind(name, value):
    for number, kind in ((1, bool), (2, int), (3, float), (4, str)):
        if isinstance(value, kind):
            return number
    if isinstance(value, (bytes, bytearray)):
        return 5
    if isinstance(value, (list, tuple)):
        for number, kinds in ((6, bool), (7, int), (8, (int, float)), (9, str)):
            if all(isinstance(each, kinds) and (number == 6 or not isinstance(each, bool)) for each in value):
                return number if value else 9
    raise ParameterError(f"{name} = {value!r}: a parameter is a bool, int, float, str, bytes, or a list of one of the first four")
