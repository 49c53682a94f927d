"""Machines of a server: their names, and the actions that they declare."""

import json
import pathlib
from dataclasses import dataclass, field

from rafcon.core.storage import storage

#: Keys in the semantic data of a root that make it an action: ``{"ros": {"action": {"name": …, "type": …}}}``.
SECTION, ENTRY = "ros", "action"
_FILE = "semantic_data.json"
#: Maximum nesting of folders.
_DEPTH_MAX = 32


@dataclass(frozen=True)
class Machine:
    """Machine on disk."""

    project: str
    #: Path of its folder in the project.
    path: str
    #: Absolute path of its folder.
    folder: str

    @property
    def name(self):
        """Name of the machine in goals."""
        return f"{self.project}/{self.path}"


@dataclass(frozen=True)
class Declared:
    """Action that a machine declares."""

    machine: Machine
    action: str
    type: str
    inputs: frozenset = field(default_factory=frozenset)
    outputs: frozenset = field(default_factory=frozenset)


class WrongDeclaration(Exception):
    """A machine declares an invalid action; the message gives the reason."""


def machines(client):
    """List all machines of all projects."""
    found = []
    for project in client.get("projects"):
        _gather(client, project, [client.get("projects", project["id"], "tree")], found, 0)
    return sorted(found, key=lambda each: each.name)


def _gather(client, project, nodes, found, depth):
    for node in nodes:
        if node["kind"] == "machine":
            found.append(Machine(project["id"], node["path"], str(pathlib.Path(project["folder"], node["path"]))))
            continue
        if node.get("is_cut") and depth < _DEPTH_MAX:
            node = client.get("projects", project["id"], "tree", path=node["path"])
        _gather(client, project, node.get("children", ()), found, depth + 1)


def chosen(known, text):
    """Return the machine that a goal names, or a text that explains why there is none.

    A goal names ``PROJECT/PATH``, or the end of the path if only one machine has it.
    """
    text = text.strip("/")
    by_name = [each for each in known if each.name == text]
    fitting = by_name or [each for each in known if text and ("/" + each.path).endswith("/" + text)]
    if len(fitting) == 1:
        return fitting[0]
    if not fitting:
        some = ", ".join(each.name for each in known[:5])
        return f"there is no machine `{text}`; there are {some or 'none'}{' and others' if len(known) > 5 else ''}"
    return f"`{text}` can be {' or '.join(each.name for each in fitting)}: write one of these"


def declared(machine):
    """Action that a machine declares, or None; :class:`WrongDeclaration` if it is invalid."""
    if not _may_declare(machine.folder):
        return None
    try:
        root = storage.load_state_machine_from_path(machine.folder).root_state
    except (ValueError, OSError) as error:
        raise WrongDeclaration(f"{machine.name} cannot be read: {error}") from error
    section = root.semantic_data.get(SECTION)
    entry = section.get(ENTRY) if hasattr(section, "get") else None
    if not entry:
        return None
    where = f"the semantic data {SECTION}.{ENTRY} of {machine.name}"
    if not hasattr(entry, "get") or not isinstance(entry.get("type"), str) or not entry["type"]:
        raise WrongDeclaration(f'{where} has no `type`: write {{"name": "fetch", "type": "my_msgs/action/Fetch"}}')
    name = entry.get("name") or machine.path.rpartition("/")[2]
    if not isinstance(name, str):
        raise WrongDeclaration(f"{where}: `name` is no text")
    ports = [frozenset(port.name for port in each.values()) for each in (root.input_data_ports, root.output_data_ports)]
    return Declared(machine, name, entry["type"], *ports)


def check_inputs(machine, names):
    """Describe an input name that the machine does not have; empty if all names are valid."""
    if not names:
        return ""
    try:
        ports = storage.load_state_machine_from_path(machine.folder).root_state.input_data_ports
    except (ValueError, OSError):
        # The start reports why it cannot be read.
        return ""
    known = sorted(port.name for port in ports.values())
    strange = sorted(set(names) - set(known))
    return f"{machine.name} has no input `{strange[0]}`; it has {', '.join(known) or 'none'}" if strange else ""


def _may_declare(folder):
    """True if semantic data of the machine's root mentions ROS; avoids loading other machines."""
    place = pathlib.Path(folder)
    # Older machines have a folder for their root.
    for file in (place / _FILE, *place.glob("*/" + _FILE)):
        try:
            if SECTION in json.loads(file.read_text("utf-8")):
                return True
        except (OSError, ValueError, TypeError):
            continue
    return False
