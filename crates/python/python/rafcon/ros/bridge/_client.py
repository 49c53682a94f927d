"""Requests to the server, with the standard library only."""

import hashlib
import http.client
import json
import ssl
import threading
import urllib.parse

#: Response timeout (s).
ANSWER_S = 5.0
#: Maximum length of an address in an error.
_SHOWN_MAX = 200


class Refused(Exception):
    """The server has refused a request; the message gives the reason."""


class NoAnswer(Exception):
    """The server could not be reached, or did not respond in time."""


class Client:
    """Client of the server, for any thread."""

    def __init__(self, url, token, fingerprint=None):
        self._address = urllib.parse.urlsplit(url)
        self._headers = {"Authorization": f"Bearer {token}", "Content-Type": "application/json"}
        self._fingerprint = fingerprint and fingerprint.replace(":", "").lower()
        self._kept = threading.local()

    def get(self, *path, **query):
        """Request a resource; ``path`` is a sequence of its parts. Return the response."""
        return self._ask("GET", _address(path) + ("?" + urllib.parse.urlencode(query) if query else ""), None, ANSWER_S)

    def post(self, path, body, patience_s=ANSWER_S):
        """Send a command to the server; return the response.

        A request on a kept connection that has closed is sent again: requests with an id are
        idempotent.
        """
        return self._ask("POST", _address(path), json.dumps(body, allow_nan=False), patience_s)

    def _ask(self, method, address, body, patience_s):
        is_kept = getattr(self._kept, "connection", None) is not None
        try:
            return self._once(method, address, body, patience_s)
        except (OSError, http.client.HTTPException) as error:
            if not is_kept or isinstance(error, TimeoutError):
                raise NoAnswer(f"the server of RAFCON does not answer: {error}") from error
        try:
            return self._once(method, address, body, patience_s)
        except (OSError, http.client.HTTPException) as error:
            raise NoAnswer(f"the server of RAFCON does not answer: {error}") from error

    def _once(self, method, address, body, patience_s):
        connection = getattr(self._kept, "connection", None) or self._connected()
        try:
            connection.sock.settimeout(patience_s)
            try:
                connection.request(method, address, body, self._headers)
            except (BrokenPipeError, ConnectionResetError):
                # The server may have refused the request before it was sent completely; read its response.
                pass
            answer = connection.getresponse()
            text = answer.read()
        except BaseException:
            self._forget()
            raise
        if connection.sock is None:
            # The server has closed the connection after its response.
            self._forget()
        value = _value(text)
        if answer.status >= 400:
            said = value.get("message") if isinstance(value, dict) else None
            raise Refused(said or f"{method} {_shortened(address)}: the server answers {answer.status} {answer.reason}")
        return value

    def _connected(self):
        host, port = self._address.hostname, self._address.port
        if self._address.scheme == "https":
            connection = http.client.HTTPSConnection(host, port, timeout=ANSWER_S, context=_any_certificate())
            connection.connect()
            found = hashlib.sha256(connection.sock.getpeercert(True)).hexdigest()
            if found != self._fingerprint:
                connection.close()
                raise NoAnswer(f"{self._address.netloc} has the certificate {found}, not that of the server")
        else:
            connection = http.client.HTTPConnection(host, port, timeout=ANSWER_S)
            connection.connect()
        self._kept.connection = connection
        return connection

    def _forget(self):
        connection = getattr(self._kept, "connection", None)
        self._kept.connection = None
        if connection is not None:
            connection.close()


def _address(path):
    """Path of a URL; each name is one part of it, whatever its characters."""
    return "".join(["/api/v1", *("/" + urllib.parse.quote(str(part), safe="", errors="replace") for part in path)])


def _shortened(address):
    return address if len(address) <= _SHOWN_MAX else address[:_SHOWN_MAX] + "…"


def _value(text):
    """JSON of a response; None if it is empty or no JSON."""
    try:
        return json.loads(text) if text else None
    except ValueError:
        return None


def _any_certificate():
    # The server's certificate is identified by its fingerprint, which is compared before any data is sent.
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.check_hostname = False
    context.verify_mode = ssl.CERT_NONE
    return context
