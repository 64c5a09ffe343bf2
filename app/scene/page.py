"""The viewer's page: viser's own client, served by the app from viser's package folder.

The client is one HTML file that carries its scripts, fonts and WebAssembly inside, packed; that is why its policy must
allow inline scripts. It may talk to the app's origin and to nobody else.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import viser

_CLIENT = Path(viser.__file__).resolve().parent / "client" / "build" / "index.html"

# viser draws a control panel over the scene, which has nothing to control here, and a bar of notices.
_STYLE = "<style>[data-floating-window],[data-dock-bar],.mantine-Notifications-root{display:none!important}</style>"


@cache
def page_html() -> bytes:
    """The viewer's page, without viser's control panel."""
    head, end, rest = _CLIENT.read_text(encoding="utf-8").partition("</head>")
    return f"{head}{_STYLE}{end}{rest}".encode()


def page_headers(host: str) -> dict[str, str]:
    """Headers of the page for a request to ``host`` (a Host header that was checked before)."""
    policy = (
        "default-src 'none'",
        "script-src 'unsafe-inline' 'wasm-unsafe-eval' blob:",
        "worker-src blob:",
        "style-src 'unsafe-inline'",
        "img-src data: blob:",
        "font-src data:",
        f"connect-src data: blob: ws://{host} wss://{host}",
        "base-uri 'none'",
        "form-action 'none'",
        "frame-ancestors 'self'",
    )
    return {"content-security-policy": "; ".join(policy), "cache-control": "no-store"}
