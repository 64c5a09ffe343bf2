"""What the browser is allowed to do with the app: the gate in front of every request.

Hindsight has no login, so the machine's own browser is the way in for an attacker: a foreign web page can send requests
to loopback (CSRF), or point its own name at loopback to become "same origin" (DNS rebinding). The gate closes both:

- the Host header must name this machine or an allowed host;
- requests that change something, and every WebSocket, must come from the page's own origin;
- each response carries headers that keep the page from talking to, or being framed by, other origins.

It is plain ASGI: bodies pass through untouched, so uploads and server-sent events stream.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from fastapi import FastAPI
from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

_LOOPBACK_NAMES = frozenset({"localhost", "127.0.0.1", "[::1]"})
_SAFE_METHODS = frozenset({"GET", "HEAD", "OPTIONS"})
_HOST = re.compile(r"(?P<name>\[[0-9a-f:.]+\]|[a-z0-9._-]+)(:\d{1,5})?")
_DEFAULT_PORTS = {"http": 80, "https": 443}

_CONTENT_SECURITY_POLICY = "; ".join(
    (
        "default-src 'self'",
        "script-src 'self'",
        "style-src 'self' 'unsafe-inline'",
        "img-src 'self' data: blob:",
        "font-src 'self' data:",
        "connect-src 'self'",
        "frame-src 'self'",
        "object-src 'none'",
        "base-uri 'self'",
        "form-action 'self'",
        "frame-ancestors 'self'",
    )
)
_HEADERS = {
    "content-security-policy": _CONTENT_SECURITY_POLICY,
    "x-content-type-options": "nosniff",
    "x-frame-options": "SAMEORIGIN",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "permissions-policy": "camera=(), geolocation=(), microphone=()",
}


def install_security(app: FastAPI, *, allowed_hosts: Sequence[str] = ()) -> None:
    """Put the gate in front of ``app``; call it last, so that it is the outermost middleware.

    ``allowed_hosts`` are further names by which browsers reach the app, as in the Host header: ``labels.example`` (any
    port) or ``labels.example:8443`` (that port). Exactly as written, an entry is also accepted as an Origin.
    """
    app.add_middleware(SecurityMiddleware, allowed_hosts=allowed_hosts)


class SecurityMiddleware:
    """ASGI middleware that refuses foreign requests and adds the security headers. See the module.

    A response that sets one of the headers itself keeps its own value: the 3D view needs a policy of its own.
    """

    def __init__(self, app: ASGIApp, *, allowed_hosts: Sequence[str] = ()) -> None:
        self._app = app
        self._allowed = frozenset(host.strip().lower() for host in allowed_hosts)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        refusal = self._refusal(scope)
        if refusal is None:
            await self._app(scope, receive, _with_security_headers(send))
        elif scope["type"] == "http":
            await _refuse_http(refusal, send, kind="http")
        else:
            await _refuse_websocket(refusal, scope, receive, send)

    def _refusal(self, scope: Scope) -> _Refusal | None:
        """Why this request is refused, or None."""
        headers = Headers(scope=scope)
        hosts = headers.getlist("host")
        if len(hosts) != 1 or not self._is_own_host(hosts[0]):
            named = ", ".join(hosts)
            return _Refusal(
                421,
                "wrong_host",
                f"This server does not answer to the name {named!r}. Open it as localhost, or start it with that name "
                "among the allowed hosts.",
            )
        if scope["type"] == "http" and scope["method"] in _SAFE_METHODS:
            return None
        origins = headers.getlist("origin")
        if not origins:
            if scope["type"] == "websocket":
                return _cross_origin("a connection that names no origin")
            if headers.get("sec-fetch-site", "none") not in ("same-origin", "none"):
                return _cross_origin("another site")
            return None
        if len(origins) != 1 or not self._is_own_origin(origins[0], hosts[0]):
            return _cross_origin(", ".join(origins))
        if headers.get("sec-fetch-site") == "cross-site":
            return _cross_origin("another site")
        return None

    def _is_own_host(self, host: str) -> bool:
        host = host.lower()
        parts = _HOST.fullmatch(host)
        if parts is None:
            return False
        return parts["name"] in _LOOPBACK_NAMES or parts["name"] in self._allowed or host in self._allowed

    def _is_own_origin(self, origin: str, host: str) -> bool:
        scheme, _, netloc = origin.lower().partition("://")
        default_port = _DEFAULT_PORTS.get(scheme)
        if default_port is None:
            return False
        return _with_port(netloc, default_port) == _with_port(host.lower(), default_port) or netloc in self._allowed


@dataclass(frozen=True)
class _Refusal:
    """An answer to a request that goes no further."""

    status: int
    code: str
    message: str

    @property
    def body(self) -> bytes:
        return json.dumps({"detail": {"code": self.code, "message": self.message}}).encode()


def _cross_origin(source: str) -> _Refusal:
    return _Refusal(
        403,
        "cross_origin",
        f"Refused a request from {source}: only Hindsight's own page may do this. Open Hindsight itself and try there.",
    )


def _with_port(netloc: str, default_port: int) -> str:
    parts = _HOST.fullmatch(netloc)
    return netloc if parts is not None and parts[2] else f"{netloc}:{default_port}"


def _with_security_headers(send: Send) -> Send:
    async def send_with_headers(message: Message) -> None:
        if message["type"] in ("http.response.start", "websocket.http.response.start"):
            headers = MutableHeaders(scope=message)
            for name, value in _HEADERS.items():
                headers.setdefault(name, value)
        await send(message)

    return send_with_headers


async def _refuse_http(refusal: _Refusal, send: Send, *, kind: str) -> None:
    headers: Iterable[tuple[bytes, bytes]] = [
        (b"content-type", b"application/json"),
        (b"content-length", str(len(refusal.body)).encode()),
        (b"connection", b"close"),
    ]
    guarded = _with_security_headers(send)
    await guarded({"type": f"{kind}.response.start", "status": refusal.status, "headers": headers})
    await guarded({"type": f"{kind}.response.body", "body": refusal.body, "more_body": False})


async def _refuse_websocket(refusal: _Refusal, scope: Scope, receive: Receive, send: Send) -> None:
    await receive()  # websocket.connect: the handshake waits for an answer
    if "websocket.http.response" in scope.get("extensions", {}):
        await _refuse_http(refusal, send, kind="websocket.http")
    else:
        await send({"type": "websocket.close", "code": 1008})
