"""Descriptions of unknown message types, requested from their users (``get_type_description``).

A description is accepted if its hash is the one that its users announce with their topics.
"""

import queue
import time

from rafcon.ros._backend import RosError, UnknownType

#: Environment variable with folders of interface files.
_VARIABLE = "RAFCON_ROS_TYPES"

_SERVICE = "type_description_interfaces/srv/GetTypeDescription"
#: Timeouts (s) for finding users of a type, and for asking them.
_FIND_S, _ASK_S = 1.8, 2.0
_LOOK_EVERY_S = 0.05
#: Maximum number of users to ask, in case the first ones do not respond.
_USERS_MAX = 3


class Descriptions:
    """Requests types on behalf of a back end."""

    def __init__(self, backend, ask, say):
        self._backend = backend
        self._ask = ask
        self._say = say

    def complete(self, name, error):
        """Teach the helper an unknown message type; ``UnknownType`` if that fails.

        The message of the exception begins with ``error``.
        """
        if "/msg/" not in name:
            # Its users announce the hashes of requests and responses, but describe the whole service only to clients that
            # know its hash.
            raise UnknownType(str(error))
        users = self._users([name], time.monotonic() + _FIND_S).get(name)
        failed = self._learn(name, users) if users else []
        if failed or not users:
            raise UnknownType(f"{error}. Its users did not help: {'; '.join(failed)}" if failed else str(error))

    def correct(self, name):
        """Teach the helper a message type again if its users have another version.

        Users of a service or an action cannot be asked for their version; then the difference is
        logged.
        """
        wanted = parts(name)
        own = self._ask("hashes", types=wanted)
        users = self._users(wanted, 0) if own else {}
        for each, hash_ in own.items():
            others = users.get(each, [])
            if others and hash_ not in [other for other, _node in others]:
                failed = self._learn(each, others) if "/msg/" in each else [f"put its file into a folder that {_VARIABLE} names"]
                text = "; ".join(failed) if failed else "theirs is used"
                self._say("warning" if failed else "info", f"{others[0][1]} uses another version of {each}: {text}")

    def _users(self, wanted, end_s):
        while True:
            found = {}
            for name, hash_, node in self._ask("users", types=wanted):
                found.setdefault(name, []).append((hash_, node))
            if len(found) == len(wanted) or time.monotonic() >= end_s:
                return found
            time.sleep(_LOOK_EVERY_S)

    def _learn(self, name, users):
        """Return the reasons of failures; empty after success."""
        why = []
        for hash_, node in users[:_USERS_MAX]:
            try:
                self._ask("learn", hash=hash_, description=self._described(name, hash_, node))
                return []
            except RosError as error:
                why.append(f"{node}: {error}")
        return why

    def _described(self, name, hash_, node):
        answers = queue.SimpleQueue()
        client = self._backend.client(f"{node}/get_type_description", _SERVICE)
        try:
            end_s = time.monotonic() + _ASK_S
            while not client.servers():
                if time.monotonic() >= end_s:
                    raise RosError("it describes no types")
                time.sleep(_LOOK_EVERY_S)
            request = {"type_name": name, "type_hash": hash_, "include_type_sources": False}
            client.send(request, lambda response, why: answers.put((response, why)))
            try:
                response, why = answers.get(timeout=_ASK_S)
            except queue.Empty:
                raise RosError(f"it has not described {name} within {_ASK_S} s") from None
        finally:
            client.close()
        if response is None or not response["successful"]:
            raise RosError(why or response["failure_reason"] or "it gives no reason")
        return response["type_description"]


def parts(name):
    """Message types that users of a type announce; parts of a service or an action."""
    if "/srv/" in name:
        return [f"{name}_{part}" for part in ("Request", "Response")]
    if "/action/" in name:
        return [f"{name}_{part}" for part in ("SendGoal_Request", "GetResult_Response", "FeedbackMessage")]
    return [name]
