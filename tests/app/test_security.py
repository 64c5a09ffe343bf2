"""The gate: which requests pass, what refused ones say, and what is left alone."""

import asyncio
import json
from collections.abc import Sequence
from typing import Any

import pytest
from fastapi import FastAPI, WebSocket
from fastapi.responses import PlainTextResponse
from starlette.types import Message

from app.security import install_security

HOST = "localhost:8000"
HOME = "http://localhost:8000"


def make_app(allowed_hosts: Sequence[str] = ()) -> FastAPI:
    app = FastAPI()

    @app.api_route("/thing", methods=["GET", "POST", "DELETE"])
    def thing() -> dict[str, bool]:
        return {"reached": True}

    @app.get("/own-policy")
    def own_policy() -> PlainTextResponse:
        return PlainTextResponse("x", headers={"content-security-policy": "default-src 'none'"})

    @app.websocket("/ws")
    async def socket(websocket: WebSocket) -> None:
        await websocket.accept()
        await websocket.close()

    install_security(app, allowed_hosts=allowed_hosts)
    return app


def request(
    app: FastAPI, method: str = "GET", path: str = "/thing", headers: Sequence[tuple[str, str]] = ()
) -> tuple[int, dict[str, str], bytes]:
    """Status, headers and body of one request, sent as ASGI messages so that headers go exactly as given."""
    sent: list[Message] = []

    async def receive() -> Message:
        return {"type": "http.request", "body": b"", "more_body": False}

    async def send(message: Message) -> None:
        sent.append(message)

    scope = {**_scope("http", path, headers), "method": method, "scheme": "http"}
    asyncio.run(app(scope, receive, send))
    answer_headers = {name.decode(): value.decode() for name, value in sent[0]["headers"]}
    return sent[0]["status"], answer_headers, b"".join(part.get("body", b"") for part in sent[1:])


def connect(app: FastAPI, headers: Sequence[tuple[str, str]], extensions: dict[str, Any]) -> list[Message]:
    """What the app answers to a WebSocket handshake."""
    sent: list[Message] = []
    incoming: list[Message] = [{"type": "websocket.connect"}, {"type": "websocket.disconnect", "code": 1005}]

    async def receive() -> Message:
        return incoming.pop(0)

    async def send(message: Message) -> None:
        sent.append(message)

    scope = {**_scope("websocket", "/ws", headers), "scheme": "ws", "subprotocols": [], "extensions": extensions}
    asyncio.run(app(scope, receive, send))
    return sent


def _scope(kind: str, path: str, headers: Sequence[tuple[str, str]]) -> dict[str, Any]:
    return {
        "type": kind,
        "asgi": {"version": "3.0"},
        "http_version": "1.1",
        "path": path,
        "raw_path": path.encode(),
        "query_string": b"",
        "root_path": "",
        "headers": [(name.lower().encode(), value.encode()) for name, value in headers],
        "server": ("127.0.0.1", 8000),
        "client": ("127.0.0.1", 50000),
    }


@pytest.mark.parametrize(
    ("host", "allowed", "status"),
    [
        ("localhost", (), 200),  # no port
        ("localhost:8000", (), 200),
        ("LOCALHOST:8000", (), 200),  # names ignore case
        ("127.0.0.1:1234", (), 200),
        ("[::1]:8000", (), 200),
        ("evil.example:8000", (), 421),  # DNS rebinding: the attacker's name that resolves to loopback
        ("localhost.evil.example", (), 421),
        ("127.0.0.1.nip.example", (), 421),
        ("localhost@evil.example", (), 421),  # malformed
        ("localhost:port", (), 421),
        ("", (), 421),
        ("labels.example:8443", (), 421),
        ("labels.example:8443", ("labels.example",), 200),  # a name without port covers every port
        ("labels.example:8443", ("labels.example:8443",), 200),
        ("labels.example:9", ("labels.example:8443",), 421),  # a name with port covers that port only
        ("Labels.Example", ("labels.EXAMPLE",), 200),
    ],
)
def test_only_own_names_are_answered(host: str, allowed: tuple[str, ...], status: int) -> None:
    answer, _, body = request(make_app(allowed), headers=[("Host", host)])
    assert answer == status
    if status != 200:
        assert json.loads(body)["detail"]["code"] == "wrong_host"


def test_no_host_and_two_hosts_are_refused() -> None:
    assert request(make_app(), headers=[])[0] == 421
    assert request(make_app(), headers=[("Host", HOST), ("Host", HOST)])[0] == 421


@pytest.mark.parametrize(
    ("method", "headers", "allowed", "status"),
    [
        ("POST", [("Origin", HOME)], (), 200),
        ("POST", [], (), 200),  # curl and scripts send no Origin
        ("POST", [("Sec-Fetch-Site", "same-origin"), ("Origin", HOME)], (), 200),
        ("POST", [("Origin", "http://evil.example")], (), 403),
        ("DELETE", [("Origin", "http://evil.example")], (), 403),
        ("POST", [("Origin", "http://localhost:3000")], (), 403),  # another program on this machine
        ("POST", [("Origin", "http://127.0.0.1:8000")], (), 403),  # another name is another origin
        ("POST", [("Origin", "null")], (), 403),  # sandboxed frames and files
        ("POST", [("Origin", HOME), ("Origin", "http://evil.example")], (), 403),
        ("POST", [("Sec-Fetch-Site", "cross-site")], (), 403),
        ("POST", [("Sec-Fetch-Site", "same-site")], (), 403),  # another port of this machine
        ("POST", [("Sec-Fetch-Site", "cross-site"), ("Origin", HOME)], (), 403),
        ("POST", [("Origin", "http://localhost:5173")], ("localhost:5173",), 200),  # a development server, allowed
        ("GET", [("Origin", "http://evil.example")], (), 200),  # reading is left to the browser's same-origin policy
        ("GET", [("Sec-Fetch-Site", "cross-site")], (), 200),  # a link from another site
    ],
)
def test_changes_come_from_the_own_page(
    method: str, headers: list[tuple[str, str]], allowed: tuple[str, ...], status: int
) -> None:
    answer, _, body = request(make_app(allowed), method, headers=[("Host", HOST), *headers])
    assert answer == status
    if status != 200:
        detail = json.loads(body)["detail"]
        assert detail["code"] == "cross_origin"
        assert detail["message"].endswith(".")


def test_default_ports_are_the_same_origin() -> None:
    app = make_app(["labels.example"])
    headers = [("Host", "labels.example"), ("Origin", "https://labels.example")]
    assert request(app, "POST", headers=headers)[0] == 200
    headers = [("Host", "localhost:80"), ("Origin", "http://localhost")]
    assert request(app, "POST", headers=headers)[0] == 200


def test_every_answer_carries_the_headers_and_may_bring_its_own_policy() -> None:
    app = make_app()
    _, headers, _ = request(app, headers=[("Host", HOST)])
    assert "default-src 'self'" in headers["content-security-policy"]
    assert "frame-ancestors 'self'" in headers["content-security-policy"]
    assert "http" not in headers["content-security-policy"]  # no other host, on any scheme
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["referrer-policy"] == "no-referrer"
    assert headers["cross-origin-opener-policy"] == "same-origin"
    assert headers["cross-origin-resource-policy"] == "same-origin"
    _, refused, _ = request(app, headers=[("Host", "evil.example")])
    assert refused["x-content-type-options"] == "nosniff"
    _, own, _ = request(app, path="/own-policy", headers=[("Host", HOST)])
    assert own["content-security-policy"] == "default-src 'none'"


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ([("Host", HOST), ("Origin", HOME)], None),
        ([("Host", HOST)], 403),  # a browser always names its origin here
        ([("Host", HOST), ("Origin", "http://evil.example")], 403),
        ([("Host", HOST), ("Origin", "null")], 403),
        ([("Host", HOST), ("Origin", HOME), ("Sec-Fetch-Site", "cross-site")], 403),
        ([("Host", "evil.example:8000"), ("Origin", "http://evil.example:8000")], 421),  # DNS rebinding
    ],
)
def test_websockets_come_from_the_own_page(headers: list[tuple[str, str]], status: int | None) -> None:
    answer = connect(make_app(), headers, {"websocket.http.response": {}})
    if status is None:
        assert answer[0]["type"] == "websocket.accept"
    else:
        assert answer[0]["type"] == "websocket.http.response.start"
        assert answer[0]["status"] == status


def test_a_server_that_cannot_answer_a_handshake_closes_it() -> None:
    assert connect(make_app(), [("Host", HOST)], {}) == [{"type": "websocket.close", "code": 1008}]


def test_bodies_stream_in_and_out() -> None:
    """Each chunk passes before the next one exists: nothing is held back."""
    log: list[str] = []

    async def echo(scope: Any, receive: Any, send: Any) -> None:
        await send({"type": "http.response.start", "status": 200, "headers": []})
        for _ in range(3):
            chunk = await receive()
            log.append(f"app read {chunk['body'].decode()}")
            await send({"type": "http.response.body", "body": chunk["body"], "more_body": True})
        await send({"type": "http.response.body", "body": b"", "more_body": False})

    app = FastAPI()
    app.mount("/", echo)
    install_security(app)
    chunks = iter("abc")

    async def receive() -> Message:
        chunk = next(chunks)
        log.append(f"client sent {chunk}")
        return {"type": "http.request", "body": chunk.encode(), "more_body": True}

    async def send(message: Message) -> None:
        if message.get("body"):
            log.append(f"client got {message['body'].decode()}")

    scope = {**_scope("http", "/", [("Host", HOST)]), "method": "POST", "scheme": "http"}
    asyncio.run(app(scope, receive, send))
    assert log == [step for c in "abc" for step in (f"client sent {c}", f"app read {c}", f"client got {c}")]
