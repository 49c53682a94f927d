"""Kinds of history entries."""

from enum import Enum

CallType = Enum("METHOD_NAME", "EXECUTE CONTAINER", module=__name__)
