"""Makes the participants of a domain announce their addresses at once.

Fast DDS responds to a participant when it discovers it. A new participant starts to listen shortly
after it has announced itself, so it often misses the response. The next one follows its next
announcement, up to three seconds later. Therefore a second participant, without readers and
writers, announces itself while the new one listens. Responses to it are forwarded unchanged to the
new one. It leaves after a second.
"""

import os
import select
import socket
import struct
import time

from rafcon.ros._liveness import DEFAULT_UNICAST, DOMAIN_GAIN, GROUP, GUID, META_UNICAST, PARTICIPANT_WRITER, PORT, announced

#: Duration (s) of listening for responses.
_LISTEN_S = 1.0
#: Times (s) of sending; several, because datagrams can get lost.
_SPEAK_S = (0.0, 0.1, 0.3)
#: Number of local processes whose ports are tried, for peers without multicast.
_LOCAL_PROCESSES = 16
#: Lease (s), for peers that miss the good-bye.
_LEASE_S = 2
_VERSION, _VENDOR, _LEASE, _ENDPOINTS, _KEY_HASH, _STATUS = 0x15, 0x16, 0x02, 0x58, 0x70, 0x71
#: Flags: it announces itself and receives announcements.
_ANNOUNCES_AND_HEARS = 3
_DISPOSED_AND_UNREGISTERED = b"\0\0\0\3"
_HERE = "127.0.0.1"


def greet(domain, own_key, note, closed):
    """Announce a participant and listen for a second.

    ``note(key, places)`` is called for each responding participant. ``closed()`` ends it early.
    """
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as made:
        try:
            made.bind(("", 0))
        except OSError:
            return
        _Greeting(made, domain, own_key, note).run(closed)


class _Greeting:
    def __init__(self, made, domain, own_key, note):
        self._socket = made
        self._multicast = PORT + DOMAIN_GAIN * domain
        self._own_key = own_key
        self._note = note
        #: Addresses of this process's participant, once it has responded.
        self._own_places = ()
        self._answers = {}
        #: One participant for each of our addresses: a known participant with another address gets no reply.
        self._spoken_as = {_HERE: os.urandom(12)}

    def run(self, closed):
        begin_s = time.monotonic()
        speak_s = list(_SPEAK_S)
        while not closed():
            passed_s = time.monotonic() - begin_s
            if speak_s and passed_s >= speak_s[0]:
                speak_s.pop(0)
                self._speak()
            if passed_s >= _LISTEN_S:
                break
            until_s = min(_LISTEN_S, *speak_s) if speak_s else _LISTEN_S
            if select.select([self._socket], [], [], max(until_s - passed_s, 0))[0]:
                self._hear()
        self._leave()

    def _speak(self):
        port = self._socket.getsockname()[1]
        for address, prefix in list(self._spoken_as.items()):
            self._tell(address, announcement(prefix, (address, port), _LEASE_S))

    def _leave(self):
        for address, prefix in self._spoken_as.items():
            self._tell(address, good_bye(prefix))

    def _tell(self, address, content):
        places = [(GROUP, self._multicast)]
        if address == _HERE:
            places += [(_HERE, self._multicast + 10 + 2 * number) for number in range(_LOCAL_PROCESSES)]
        try:
            self._socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton(address))
        except OSError:
            places.pop(0)
        for place in places:
            self._send(content, place)

    def _send(self, content, place):
        try:
            self._socket.sendto(content, place)
        except OSError:
            # Unreachable peer or network; try the others.
            pass

    def _hear(self):
        try:
            content = self._socket.recv(65536)
        except OSError:
            return
        found = announced(content)
        if found is None:
            return
        key, places = found
        if key != self._own_key:
            self._note(key, places)
            if key not in self._answers:
                self._answers[key] = content
                self._pass_on([content])
        elif not self._own_places:
            self._own_places = places
            self._pass_on(self._answers.values())
            if not is_local():
                self._speak_elsewhere()

    def _pass_on(self, contents):
        for content in contents:
            for place in self._own_places:
                self._send(content, place)

    def _speak_elsewhere(self):
        others = {address for address, _port in self._own_places} - set(self._spoken_as)
        self._spoken_as.update((address, os.urandom(12)) for address in others)
        if others:
            self._speak()


def is_local():
    """True if the environment restricts discovery to this computer."""
    wanted = os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "").upper()
    return wanted == "LOCALHOST" or os.environ.get("ROS_LOCALHOST_ONLY") == "1"


def is_wanted():
    """True if the environment permits discovery of programs by announcement."""
    is_off = os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "").upper() == "OFF"
    # A secured participant does not respond to unknown ones.
    return not is_off and os.environ.get("ROS_SECURITY_ENABLE", "").lower() != "true"


def announcement(prefix, place, lease_s):
    """RTPS message that announces a participant without readers and writers."""
    address, port = place
    locator = struct.pack("<iI", 1, port) + bytes(12) + socket.inet_aton(address)
    parameters = (
        (_VERSION, b"\2\2\0\0"),
        (_VENDOR, bytes(4)),
        (GUID, _guid(prefix)),
        (META_UNICAST, locator),
        (DEFAULT_UNICAST, locator),
        (_LEASE, struct.pack("<iI", lease_s, 0)),
        (_ENDPOINTS, struct.pack("<I", _ANNOUNCES_AND_HEARS)),
    )
    return _message(prefix, 5, 1, b"\0\3\0\0" + _list(parameters))


def good_bye(prefix):
    """RTPS message that ends a participant."""
    return _message(prefix, 3, 2, _list(((_KEY_HASH, _guid(prefix)), (_STATUS, _DISPOSED_AND_UNREGISTERED))))


def _guid(prefix):
    return prefix + b"\0\0\1\xc1"


def _list(parameters):
    return b"".join(struct.pack("<HH", number, len(value)) + value for number, value in parameters) + b"\1\0\0\0"


def _message(prefix, flags, number, rest):
    body = struct.pack("<HHI", 0, 16, 0) + struct.pack(">I", PARTICIPANT_WRITER) + struct.pack("<II", 0, number) + rest
    return b"RTPS\2\2\0\0" + prefix + struct.pack("<BBH", 0x15, flags, len(body)) + body
