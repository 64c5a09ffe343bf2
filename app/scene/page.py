"""The viewer's page: viser's own client, served by the app from viser's package folder.

The client is one HTML file that carries its scripts, fonts and WebAssembly inside, packed; that is why its policy must
allow inline scripts. It may talk to the app's origin and to nobody else.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import viser

from app.scene.palette import scene_palette
from app.scene.types import Theme

_CLIENT = Path(viser.__file__).resolve().parent / "client" / "build" / "index.html"

# Of the client's page, only the canvas is for us. viser lays a control panel over it, in one of two places depending on
# the width, and notices; hiding all but canvases holds whatever those are called. The page's own background then shows.
_STYLE = """<style>
body * { visibility: hidden }
body canvas { visibility: visible }
:root[data-mantine-color-scheme="dark"] body { background: rgb%s }
:root[data-mantine-color-scheme="light"] body { background: rgb%s }
</style>"""


@cache
def page_html() -> bytes:
    """The viewer's page, without viser's own controls."""
    head, end, rest = _CLIENT.read_text(encoding="utf-8").partition("</head>")
    style = _STYLE % tuple(str(scene_palette(theme).background) for theme in (Theme.DARK, Theme.LIGHT))
    return f"{head}{style}{end}{rest}".encode()


def page_headers(host: str) -> dict[str, str]:
    """Headers of the page for a request to ``host`` (a Host header that was checked before).

    The viewer's WebAssembly makes its bindings by evaluating strings, which adds nothing to what inline scripts may do.
    """
    policy = (
        "default-src 'none'",
        "script-src 'unsafe-inline' 'unsafe-eval' blob:",
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
