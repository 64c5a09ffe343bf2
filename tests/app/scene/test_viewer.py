"""The private viser server: reached by nobody without the key, silent, and never shared."""

import socket
from typing import Any

import psutil
import pytest
import viser
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect
from websockets.typing import Subprotocol

from app.scene.viewer import KEY_HEADER, LOOPBACK, PrivateViewer

PROTOCOL = Subprotocol(f"viser-v{viser.__version__}")


def listening_addresses(port: int) -> list[str]:
    connections = psutil.Process().net_connections(kind="tcp")
    return [c.laddr.ip for c in connections if c.status == psutil.CONN_LISTEN and c.laddr.port == port]


def test_it_listens_on_loopback_only_and_frees_the_port_on_closing() -> None:
    viewer = PrivateViewer()
    assert listening_addresses(viewer.port) == [LOOPBACK]
    viewer.close()
    assert listening_addresses(viewer.port) == []


def test_two_viewers_have_ports_and_keys_of_their_own() -> None:
    first, second = PrivateViewer(), PrivateViewer()
    try:
        assert first.port != second.port
        assert first.key != second.key
        with socket.create_connection((LOOPBACK, second.port), timeout=5):
            pass
    finally:
        first.close()
        second.close()


def test_a_fixed_port_that_is_taken_does_not_mislead(monkeypatch: pytest.MonkeyPatch) -> None:
    """viser takes the next port silently; what counts is the one it really has."""
    with socket.create_server((LOOPBACK, 0)) as taken:
        monkeypatch.setenv("_VISER_PORT_OVERRIDE", str(taken.getsockname()[1]))
        viewer = PrivateViewer()
        try:
            assert viewer.port != taken.getsockname()[1]
            assert listening_addresses(viewer.port) == [LOOPBACK]
        finally:
            viewer.close()


@pytest.mark.parametrize("headers", [{}, {KEY_HEADER: "wrong"}, {"Origin": "http://evil.example"}])
def test_without_the_key_nothing_is_told(headers: dict[str, str]) -> None:
    viewer = PrivateViewer()
    viewer.server.scene.add_label("/secret", "secret")
    try:
        with (
            connect(viewer.url, subprotocols=[PROTOCOL], additional_headers=headers, proxy=None) as client,
            pytest.raises(ConnectionClosed) as closed,
        ):
            client.recv(timeout=5)
        assert closed.value.rcvd is not None
        assert closed.value.rcvd.code == 1008
    finally:
        viewer.close()


def test_with_the_key_the_scene_arrives() -> None:
    viewer = PrivateViewer()
    viewer.server.scene.add_label("/secret", "secret")
    try:
        with connect(
            viewer.url, subprotocols=[PROTOCOL], additional_headers={KEY_HEADER: viewer.key}, proxy=None
        ) as client:
            assert isinstance(client.recv(timeout=5), bytes)
    finally:
        viewer.close()


def test_it_prints_nothing(capfd: pytest.CaptureFixture[str]) -> None:
    viewer = PrivateViewer()
    other_release = Subprotocol("viser-v0.0.0")  # it complains of those
    with connect(viewer.url, subprotocols=[other_release], proxy=None) as client, pytest.raises(ConnectionClosed):
        client.recv(timeout=5)
    viewer.close()  # "Server stopped"
    assert capfd.readouterr().out == ""


def test_sharing_makes_no_tunnel(monkeypatch: pytest.MonkeyPatch) -> None:
    tunnels: list[tuple[Any, ...]] = []

    def tunnel(*arguments: Any) -> None:
        tunnels.append(arguments)
        raise ConnectionError("a tunnel was opened")

    monkeypatch.setattr("viser._viser.ViserTunnel", tunnel)
    viewer = PrivateViewer()
    try:
        assert viewer.server.request_share_url() is None
        viewer.server.disconnect_share_url()
        assert tunnels == []
    finally:
        viewer.close()
