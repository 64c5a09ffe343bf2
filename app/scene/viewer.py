"""A viser server that only this program can reach.

viser is made for trusted desks: it has no login, accepts a WebSocket from any web page, and any client of it may open a
tunnel to a public share server. So here:

- it listens on loopback only, on a port that the system picks, and that is checked;
- a WebSocket without the viewer's own key is closed before it is sent anything. The proxy knows the key; a browser
  can't set a header on a WebSocket, so a foreign page that guesses the port gets nothing;
- the share tunnel does not exist;
- nothing is printed.
"""

from __future__ import annotations

import hmac
import secrets
from typing import Any

import psutil
import rich
import viser

from app.scene.errors import ViewerFailed

LOOPBACK = "127.0.0.1"
KEY_HEADER = "X-Hindsight-Viewer-Key"


class PrivateViewer:
    """One running viser server. ``server`` draws; ``url`` with ``key`` in the header KEY_HEADER connects to it."""

    def __init__(self) -> None:
        """Start it. ViewerFailed when it does not listen on loopback alone."""
        console = rich.get_console()
        with console.capture():  # holds this thread's banner only; other threads print as before
            self.server = _UnsharedServer(host=LOOPBACK, port=0, verbose=False)
        self.server.get_event_loop().call_soon_threadsafe(console.begin_capture)  # and what its own thread prints
        self.key = secrets.token_urlsafe(32)
        self.port = self.server.get_port()
        try:
            _require_loopback_only(self.port)
            self._admit_key_holders_only()
        except BaseException:  # whatever stops this, no server without its lock stays open
            self.server.stop()
            raise

    @property
    def url(self) -> str:
        return f"ws://{LOOPBACK}:{self.port}/"

    def close(self) -> None:
        """Disconnect every client and free the port."""
        self.server.stop()

    def _admit_key_holders_only(self) -> None:
        # viser runs these callbacks before it sends or reads anything, and offers no public way to see the handshake.
        websocket_server: Any = self.server._websock_server

        async def admit(client: Any) -> None:
            connection = websocket_server._live_connections[client.client_id]
            key = connection.request.headers.get(KEY_HEADER, "")
            if not hmac.compare_digest(key.encode(), self.key.encode()):
                await connection.close(1008, "this viewer is private")

        websocket_server.on_client_connect(admit)
        websocket_server.disconnect_all_clients()  # whoever was faster than the line above


class _UnsharedServer(viser.ViserServer):
    """A viser server without the share tunnel. Its clients' share requests end here."""

    def request_share_url(self, verbose: bool = True) -> str | None:
        """Never shared: always None."""
        return None

    def disconnect_share_url(self) -> None:
        """Nothing to disconnect."""


def _require_loopback_only(port: int) -> None:
    listening = [
        connection.laddr.ip
        for connection in psutil.Process().net_connections(kind="tcp")
        if connection.status == psutil.CONN_LISTEN and connection.laddr.port == port
    ]
    if listening != [LOOPBACK]:
        where = ", ".join(listening) or "nowhere"
        raise ViewerFailed(
            f"The 3D viewer should listen on {LOOPBACK} port {port} alone but listens on {where}. It was stopped; "
            "reinstall the viser release that Hindsight asks for."
        )
