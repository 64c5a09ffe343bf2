"""A web server on 127.0.0.1 that holds model files, and behaves as badly as it is told to."""

from __future__ import annotations

import ssl
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

CERTIFICATE = Path(__file__).parent / "self_signed.pem"


@dataclass
class Behaviour:
    """``files`` by name. ``break_after`` ends each answer after so many bytes of it; ``before_rest`` is called when the
    first half of an answer is sent; ``headers_seen`` is what was asked, request by request."""

    files: dict[str, bytes] = field(default_factory=dict[str, bytes])
    honours_ranges: bool = True
    break_after: int | None = None
    says_length: bool = True
    content_type: str = "application/octet-stream"
    content_range: str | None = None
    status: int | None = None
    etag: str = '"1"'
    tunnel_status: int = HTTPStatus.PROXY_AUTHENTICATION_REQUIRED
    before_rest: Callable[[], None] = lambda: None
    requests: list[tuple[str, str | None]] = field(default_factory=list[tuple[str, str | None]])


@contextmanager
def serving(behaviour: Behaviour, *, encrypted: bool = False) -> Iterator[str]:
    """The address of a server that behaves so, as long as the block lasts."""

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            asked = self.headers.get("Range")
            behaviour.requests.append((self.path, asked))
            content = behaviour.files.get(self.path.rpartition("/")[2])
            if behaviour.status is not None or content is None:
                self.send_error(behaviour.status or HTTPStatus.NOT_FOUND)
                return
            start = 0
            unchanged = self.headers.get("If-Range") in (None, behaviour.etag)
            if asked is not None and behaviour.honours_ranges and unchanged:
                start = int(asked.removeprefix("bytes=").removesuffix("-"))
                if start >= len(content):
                    self.send_error(HTTPStatus.REQUESTED_RANGE_NOT_SATISFIABLE)
                    return
                self.send_response(HTTPStatus.PARTIAL_CONTENT)
                said = behaviour.content_range or f"bytes {start}-{len(content) - 1}/{len(content)}"
                self.send_header("Content-Range", said)
            else:
                self.send_response(HTTPStatus.OK)
            self.send_header("Content-Type", behaviour.content_type)
            self.send_header("ETag", behaviour.etag)
            body = content[start:]
            if behaviour.says_length:
                self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            body = body[: behaviour.break_after]
            self.wfile.write(body[: len(body) // 2])
            self.wfile.flush()
            behaviour.before_rest()
            self.wfile.write(body[len(body) // 2 :])

        def do_CONNECT(self) -> None:
            behaviour.requests.append((self.path, None))
            self.send_error(behaviour.tunnel_status)

        def log_message(self, format: str, *args: object) -> None:  # noqa: A002
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    server.daemon_threads = False  # closing waits for them
    if encrypted:
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        context.load_cert_chain(CERTIFICATE)
        server.socket = context.wrap_socket(server.socket, server_side=True)
        server.handle_error = lambda request, client_address: None  # type: ignore[method-assign]  # a client that turns away
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.02})
    thread.start()
    try:
        yield f"{'https' if encrypted else 'http'}://127.0.0.1:{server.server_port}"
    finally:
        server.shutdown()
        thread.join()
        server.server_close()
