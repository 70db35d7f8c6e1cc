"""HTTP to the viewer: one short connection for each request, and one long one for events."""
from __future__ import annotations

import http.client
import json
import os
import pathlib
import socket
import urllib.parse
from typing import Any, Dict, Iterator, NamedTuple, Optional, Tuple

from .errors import Refused, Unreachable


class Event(NamedTuple):
    """One of the viewer's events: state, nodes, processes, hypotheses, path, picture or tile."""

    name: str
    data: Any


class Connection:
    """Asks the viewer at `address`. The token is the one given, or $LUMINAV_TOKEN, or this machine's own."""

    def __init__(self, address: str, token: Optional[str], timeout: float) -> None:
        parts = urllib.parse.urlsplit(address if "//" in address else "http://" + address)
        if parts.scheme != "http" or not parts.hostname:
            raise ValueError(f"{address}: must be http://HOST:PORT")
        self.host: str = parts.hostname
        self.port = parts.port or 8080
        self.timeout = timeout  # [s] for an answer
        self._token = token or os.environ.get("LUMINAV_TOKEN") or None

    def get(self, path: str) -> Any:
        """Returns the JSON that stands there."""
        return json.loads(self.get_bytes(path))

    def get_bytes(self, path: str) -> bytes:
        return self._read(*self._look(path))

    def post(self, name: str, body: Any) -> Any:
        """Sends a command with the token and returns the JSON of the answer."""
        self.token()
        headers = {"Content-Type": "application/json", **self._token_header()}
        return json.loads(self._read(*self._open("POST", f"/api/{name}", json.dumps(body).encode(), headers, self.port)))

    def post_stop(self) -> Any:
        """Sends a STOP: without token, to the page's port or to the next one, where only commands are taken."""
        for port in (self.port, self.port + 1):
            try:
                return json.loads(self._read(*self._open("POST", "/api/stop", b'{"engaged":true}', {}, port)))
            except Unreachable as error:
                unreachable = error
        raise unreachable

    def token(self) -> Optional[str]:
        if self._token is None and self._is_this_machine():
            settings = self.get("/settings.json")
            if settings["needs_token"]:
                self._token = self._token_of_this_machine(settings["robot"])
        return self._token

    def events(self) -> Iterator[Event]:
        """Yields what comes until the connection ends; then raises Unreachable."""
        connection, answer = self._look("/events")
        name = ""
        try:
            for line in answer:
                text = line.decode().rstrip("\n")
                if text.startswith("event: "):
                    name = text[7:]
                elif text.startswith("data: "):
                    yield Event(name, json.loads(text[6:]))
        except (OSError, http.client.HTTPException) as error:
            raise Unreachable(f"the events of {self.host}:{self.port} broke off: {error}") from None
        finally:
            connection.close()
        raise Unreachable(f"the events of {self.host}:{self.port} ended")

    def _look(self, path: str) -> Tuple[http.client.HTTPConnection, http.client.HTTPResponse]:
        """Opens what is looked at; with this machine's token only where looking needs one."""
        try:
            return self._open("GET", path, b"", self._token_header(), self.port)
        except Refused as refused:
            if refused.status != 403 or self._token or not self.token():
                raise
        return self._open("GET", path, b"", self._token_header(), self.port)

    def _token_header(self) -> Dict[str, str]:
        return {"X-Luminav-Token": self._token} if self._token else {}

    def _read(self, connection: http.client.HTTPConnection, answer: http.client.HTTPResponse) -> bytes:
        try:
            return answer.read()
        except (OSError, http.client.HTTPException) as error:
            raise Unreachable(f"the answer of {self.host} broke off: {error}") from None
        finally:
            connection.close()

    def _open(self, method: str, path: str, body: bytes, headers: Dict[str, str],
              port: int) -> Tuple[http.client.HTTPConnection, http.client.HTTPResponse]:
        connection = http.client.HTTPConnection(self.host, port, timeout=self.timeout)
        try:
            connection.request(method, path, body or None, headers)
            answer = connection.getresponse()
            if answer.status == 200:
                return connection, answer
            why = answer.read()
        except (OSError, http.client.HTTPException) as error:
            connection.close()
            raise Unreachable(f"no answer from {self.host}:{port}: {error}") from None
        connection.close()
        try:
            sentence = str(json.loads(why)["error"])
        except (ValueError, KeyError, TypeError):
            sentence = f"the viewer answers {answer.status}"
        raise Refused(sentence, answer.status)

    def _is_this_machine(self) -> bool:
        own = socket.gethostname().lower()
        return self.host in ("localhost", "::1", own, own + ".local") or self.host.startswith("127.")

    def _token_of_this_machine(self, robot: str) -> Optional[str]:
        state = os.environ.get("LUMINAV_STATE") or "~/.local/state/luminav"
        for folder in (pathlib.Path(state).expanduser(), pathlib.Path("/var/lib/luminav")):
            try:
                return (folder / robot / "viewer_token").read_text().strip()
            except OSError:
                continue
        return None
