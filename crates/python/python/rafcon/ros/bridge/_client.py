"""The server as this program uses it: requests with answers, by the standard library alone."""

import hashlib
import http.client
import json
import ssl
import threading
import urllib.parse

#: A request is answered at once (s), or the server does not answer.
ANSWER_S = 5.0


class Refused(Exception):
    """The server has refused a request; the text says why."""


class NoAnswer(Exception):
    """The server could not be reached, or did not answer in time."""


class Client:
    """Asks the server, on any thread."""

    def __init__(self, url, token, fingerprint=None):
        self._address = urllib.parse.urlsplit(url)
        self._headers = {"Authorization": f"Bearer {token}", "Content-Type": "application/json"}
        self._fingerprint = fingerprint and fingerprint.replace(":", "").lower()
        self._kept = threading.local()

    def get(self, path, **query):
        """The answer to a question."""
        return self._ask("GET", path + ("?" + urllib.parse.urlencode(query) if query else ""), None, ANSWER_S)

    def post(self, path, body, patience_s=ANSWER_S):
        """Has the server do something. What has an id is done once, so it is sent again where a kept connection was gone."""
        return self._ask("POST", path, json.dumps(body, allow_nan=False), patience_s)

    def _ask(self, method, path, body, patience_s):
        is_kept = getattr(self._kept, "connection", None) is not None
        try:
            return self._once(method, path, body, patience_s)
        except (OSError, http.client.HTTPException) as error:
            self._forget()
            if not is_kept or isinstance(error, TimeoutError):
                raise NoAnswer(f"the server of RAFCON does not answer: {error}") from error
        try:
            return self._once(method, path, body, patience_s)
        except (OSError, http.client.HTTPException) as error:
            self._forget()
            raise NoAnswer(f"the server of RAFCON does not answer: {error}") from error

    def _once(self, method, path, body, patience_s):
        connection = getattr(self._kept, "connection", None) or self._connected()
        connection.sock.settimeout(patience_s)
        connection.request(method, "/api/v1" + path, body, self._headers)
        answer = connection.getresponse()
        text = answer.read()
        value = json.loads(text) if text else None
        if answer.status >= 400:
            raise Refused(value["message"] if isinstance(value, dict) and "message" in value else f"{method} {path}: {answer.status}")
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


def _any_certificate():
    # The server's certificate is known by its fingerprint, which is compared before anything is sent.
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.check_hostname = False
    context.verify_mode = ssl.CERT_NONE
    return context
