"""Detects the end of a participant's process, long before its lease expires.

DDS keeps a participant that was killed until the end of its lease, 20 s by default. Its ports close
at once, however, and the host answers a datagram to a closed port with an error. Participants
announce their addresses (SPDP). Those that a caller waits for are probed with empty datagrams. A
participant counts as alive if its addresses are unknown or nothing answers.
"""

import errno
import ipaddress
import math
import socket
import struct
import threading
import time

GROUP = "239.255.0.1"
PORT, DOMAIN_GAIN, _DOMAINS = 7400, 250, 233
#: Interval (s) of probes of a participant that somebody waits for.
_ASK_EVERY_S = 0.2
#: Maximum number of known participants; the one silent for longest is dropped for a new one.
_PARTICIPANTS_MAX = 1000
#: Interval (s) at which the thread checks if it is still needed.
_LOOK_EVERY_S = 0.5
#: Number of consecutive refusals that mark an end.
_REFUSALS = 2
PARTICIPANT_WRITER = 0x000100C2
GUID, META_UNICAST, DEFAULT_UNICAST, _SENTINEL = 0x50, 0x32, 0x31, 0x01
_DATA = 0x15
_GONE = (errno.ECONNREFUSED,)


class Liveness:
    """Tracks the participants of a domain."""

    def __init__(self, domain):
        self._participants = {}
        self._lock = threading.Lock()
        self._closed = False
        self._domain = domain
        listening = _listening(domain)
        if listening is not None:
            threading.Thread(target=self._listen, args=(listening,), name="ros participants", daemon=True).start()

    def greet(self, own_key):
        """Make all participants announce themselves, also to our participant ``own_key``."""
        from rafcon.ros._greeting import greet

        if 0 <= self._domain < _DOMAINS:
            arguments = (self._domain, own_key, self._note, lambda: self._closed)
            threading.Thread(target=greet, args=arguments, name="ros greeting", daemon=True).start()

    def close(self):
        """Stop listening; the thread closes the sockets after the next datagram or timeout."""
        self._closed = True

    def _listen(self, listening):
        with listening:
            listening.settimeout(_LOOK_EVERY_S)
            while not self._closed:
                try:
                    content = listening.recv(65536)
                except socket.timeout:
                    continue
                except OSError:
                    break
                found = announced(content)
                if found is not None:
                    self._note(*found)
        with self._lock:
            participants, self._participants = list(self._participants.values()), {}
        for each in participants:
            each.close()

    def _note(self, key, places):
        with self._lock:
            known = self._participants.pop(key, None)
            if known is not None and known.places == places:
                known.alive()
                self._participants[key] = known
                return
            if known is not None:
                known.close()
            self._participants[key] = _Participant(places, known is None and self._replace(places))
            if len(self._participants) > _PARTICIPANTS_MAX:
                self._participants.pop(next(iter(self._participants))).close()

    def _replace(self, places):
        """Mark participants with these addresses as replaced; True if there are any.

        A restarted process takes the ports of the dead one.
        """
        before = [each for each in self._participants.values() if each.places == places]
        for each in before:
            each.is_replaced = True
        return bool(before)

    def replaced_s(self, key):
        """Time (s, monotonic) at which a participant replaced another; -inf if it did not."""
        with self._lock:
            known = self._participants.get(key)
            return -math.inf if known is None else known.replaced_s

    def has_ended(self, key):
        """True if a participant's process has ended; ``key`` is the first 12 bytes of its GUID."""
        with self._lock:
            known = self._participants.get(key)
            return known is not None and known.has_ended()


class _Participant:
    """Addresses of a participant, and the results of probes."""

    def __init__(self, places, replaces):
        self.places = places
        self.replaced_s = time.monotonic() if replaces else -math.inf
        #: True if another participant took over its places, and it has been silent since.
        self.is_replaced = False
        self._sockets = []
        self._asked_s = 0.0
        self._refusals = 0

    def alive(self):
        """Note an announcement of the participant."""
        self._refusals = 0
        self.is_replaced = False

    def has_ended(self):
        """Probe the participant if a probe is due; True if its end is known."""
        now_s = time.monotonic()
        if self._refusals < _REFUSALS and now_s - self._asked_s >= _ASK_EVERY_S:
            self._asked_s = now_s
            self._ask()
        return self.is_replaced or self._refusals >= _REFUSALS

    def _ask(self):
        if not self._sockets:
            self._sockets = [made for made in map(_connected, self.places) if made is not None]
        # All places must refuse: one may be an address that means another host here.
        refused = [_refuses(each) for each in self._sockets]
        if refused and all(refused):
            self._refusals += 1
        else:
            self._refusals = 0

    def close(self):
        """Close the sockets."""
        for each in self._sockets:
            each.close()


def _connected(place):
    made = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        made.setblocking(False)
        made.connect(place)
    except OSError:
        made.close()
        return None
    return made


#: An empty message of RTPS 2.2 without a sender.
_EMPTY = b"RTPS\x02\x02\x00\x00" + bytes(12)


def _refuses(connected):
    """Return True if the port refused the previous datagram; then send another."""
    refused = False
    try:
        connected.recv(1)
    except BlockingIOError:
        pass
    except OSError as error:
        refused = error.errno in _GONE
    try:
        connected.send(_EMPTY)
    except OSError as error:
        refused = refused or error.errno in _GONE
    return refused


def _listening(domain):
    """Open a socket for the announcements of a domain's participants; None if not possible."""
    if not 0 <= domain < _DOMAINS:
        return None
    made = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        if hasattr(socket, "SO_REUSEPORT"):
            made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
        made.bind(("", PORT + DOMAIN_GAIN * domain))
        joined = [_join(made, address) for address in ("0.0.0.0", "127.0.0.1")]  # noqa: S104, any interface, and the one for this host
        if any(joined):
            return made
    except OSError:
        pass
    made.close()
    return None


def _join(made, address):
    try:
        made.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, socket.inet_aton(GROUP) + socket.inet_aton(address))
    except OSError:
        return False
    return True


def announced(content):
    """Return (key, addresses) of the participant announced in an RTPS message, or None."""
    if len(content) < 20 or content[:4] != b"RTPS":
        return None
    at = 20
    while at + 4 <= len(content):
        kind, flags = content[at], content[at + 1]
        order = "<" if flags & 1 else ">"
        (length,) = struct.unpack_from(order + "H", content, at + 2)
        end = at + 4 + length if length else len(content)
        if kind == _DATA and end <= len(content):
            found = _of_data(content[at + 4 : end], order, flags)
            if found is not None:
                return found
        at = end
    return None


def _of_data(body, order, flags):
    if len(body) < 24 or struct.unpack_from(">I", body, 8)[0] != PARTICIPANT_WRITER or not flags & 4:
        return None
    (skip,) = struct.unpack_from(order + "H", body, 2)
    at = 4 + skip
    if flags & 2:
        at = _after_parameters(body, at, order)
    if at is None or at + 4 > len(body):
        return None
    order = "<" if body[at + 1] & 1 else ">"
    key, places = None, []
    for number, value in _parameters(body, at + 4, order):
        if number == GUID and len(value) >= 12:
            key = value[:12]
        elif number in (META_UNICAST, DEFAULT_UNICAST) and len(value) >= 24:
            kind, port = struct.unpack_from(order + "iI", value)
            if kind == 1 and 0 < port < 65536 and value[20:24] != bytes(4):
                places.append((str(ipaddress.IPv4Address(value[20:24])), port))
    return (key, tuple(sorted(set(places)))) if key and places else None


def _parameters(body, at, order):
    while at + 4 <= len(body):
        number, length = struct.unpack_from(order + "HH", body, at)
        if number == _SENTINEL or at + 4 + length > len(body):
            return
        yield number, body[at + 4 : at + 4 + length]
        at += 4 + length


def _after_parameters(body, at, order):
    while at + 4 <= len(body):
        number, length = struct.unpack_from(order + "HH", body, at)
        at += 4 + length
        if number == _SENTINEL:
            return at
    return None
