"""The routes under a real server: who may connect, and that the viewer's messages pass both ways."""

import socket
import threading
from typing import Any

import httpx
import msgspec
import pytest
import viser
import zstandard
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect
from websockets.sync.connection import Connection
from websockets.typing import Origin, Subprotocol

PROTOCOL = Subprotocol(f"viser-v{viser.__version__}")


def open_scene(server: Any, **start: object) -> str:
    answer = httpx.post(f"{server.origin}/api/drives/1/scenes", json=start, headers={"Origin": server.origin})
    assert answer.status_code == 201
    scene_id = answer.json()["scene_id"]
    assert answer.json()["url"] == f"/scene/{scene_id}/"
    assert server.scenes.get(scene_id).wait_until_drawn(10)
    return scene_id


def join(server: Any, scene_id: str, *, origin: str | None, protocol: Subprotocol = PROTOCOL) -> ClientConnection:
    return connect(
        f"ws://{server.host}/scene/{scene_id}",
        origin=None if origin is None else Origin(origin),
        subprotocols=[protocol],
        proxy=None,
        max_size=None,
    )


def messages_until(client: Connection, kind: str) -> list[dict[str, Any]]:
    """What the viewer says until a message of this kind: a packed list of messages in each frame, then raw arrays."""
    found: list[dict[str, Any]] = []
    while not any(message["type"] == kind for message in found):
        frame = client.recv(timeout=10)
        assert isinstance(frame, bytes)
        size = int.from_bytes(frame[8:16], "little")
        found += msgspec.msgpack.decode(zstandard.decompress(frame[16 : 16 + size]))["messages"]
    return found


def test_the_page_is_served_with_a_policy_that_names_no_other_host(server: Any) -> None:
    scene_id = open_scene(server)
    page = httpx.get(f"{server.origin}/scene/{scene_id}/")
    assert page.status_code == 200
    assert page.headers["content-type"].startswith("text/html")
    assert '<div id="root"></div>' in page.text
    policy = page.headers["content-security-policy"]
    assert f"connect-src data: blob: ws://{server.host} wss://{server.host};" in policy
    assert "default-src 'none'" in policy
    assert "frame-ancestors 'self'" in policy
    assert page.headers["x-content-type-options"] == "nosniff"


def test_an_unknown_scene_is_not_found(server: Any) -> None:
    for answer in (
        httpx.get(f"{server.origin}/scene/nothing/"),
        httpx.put(f"{server.origin}/api/scenes/nothing/view", json={"frame_index": 0, "identity_id": None}),
    ):
        assert answer.status_code == 404
        assert answer.json()["detail"]["code"] == "scene_not_found"
    with pytest.raises(InvalidStatus) as refused:
        join(server, "nothing", origin=server.origin)
    assert refused.value.response.status_code == 404


def test_the_scene_arrives_through_the_proxy_and_follows_the_view(server: Any) -> None:
    scene_id = open_scene(server)
    with join(server, scene_id, origin=server.origin) as client:
        assert client.subprotocol == PROTOCOL
        first = messages_until(client, "ReplayDoneMessage")
        assert {"/sweep", "/boxes/edges", "/cameras/front"} <= {message.get("name") for message in first}
        answer = httpx.put(f"{server.origin}/api/scenes/{scene_id}/view", json={"frame_index": 3, "identity_id": 3})
        assert answer.status_code == 204
        labels = [message for message in messages_until(client, "LabelMessage") if message["type"] == "LabelMessage"]
        assert [label["props"]["text"] for label in labels] == ["#3 truck 0.90"]


@pytest.mark.parametrize("origin", [None, "http://evil.example", "null", "http://localhost:1"])
def test_a_foreign_page_cannot_connect(server: Any, origin: str | None) -> None:
    scene_id = open_scene(server)
    with pytest.raises(InvalidStatus) as refused:
        join(server, scene_id, origin=origin)
    assert refused.value.response.status_code == 403


def test_a_foreign_host_is_refused(server: Any) -> None:
    scene_id = open_scene(server)
    page = httpx.get(f"{server.origin}/scene/{scene_id}/", headers={"Host": "evil.example"})
    assert page.status_code == 421


def test_the_viewers_close_code_reaches_the_page(server: Any) -> None:
    scene_id = open_scene(server)
    with (
        join(server, scene_id, origin=server.origin, protocol=Subprotocol("viser-v0.0.0")) as client,
        pytest.raises(ConnectionClosed) as closed,
    ):
        client.recv(timeout=10)
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == 1002
    assert closed.value.rcvd.reason.startswith("Version mismatch")


def test_closing_the_scene_ends_the_connection(server: Any) -> None:
    scene_id = open_scene(server)
    with join(server, scene_id, origin=server.origin) as client:
        messages_until(client, "ReplayDoneMessage")
        assert httpx.delete(f"{server.origin}/api/scenes/{scene_id}").status_code == 204
        with pytest.raises(ConnectionClosed) as closed:
            client.recv(timeout=10)
        assert closed.value.rcvd is not None
        assert closed.value.rcvd.code == 1001  # the viewer goes away
    assert httpx.get(f"{server.origin}/scene/{scene_id}/").status_code == 404


def test_stopping_the_server_closes_connected_scenes_and_frees_their_ports(server: Any) -> None:
    port = server.scenes.get(scene_id := open_scene(server)).viewer.port
    with join(server, scene_id, origin=server.origin) as client:
        messages_until(client, "ReplayDoneMessage")
        server.stop()
        with pytest.raises(ConnectionClosed):
            client.recv(timeout=10)
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.1", port), timeout=5)


def test_a_scene_is_in_use_while_its_page_is_connected(server: Any) -> None:
    scene = server.scenes.get(scene_id := open_scene(server))
    assert not scene.last_use[0]
    with join(server, scene_id, origin=server.origin) as client:
        messages_until(client, "ReplayDoneMessage")
        assert scene.last_use[0]


def test_a_clients_share_request_opens_no_tunnel(server: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    tunnels: list[object] = []
    asked = threading.Event()

    def tunnel(*arguments: object) -> None:
        tunnels.append(arguments)
        raise ConnectionError("a tunnel was opened")

    monkeypatch.setattr("viser._viser.ViserTunnel", tunnel)
    scene_id = open_scene(server)
    viewer_server = server.scenes.get(scene_id).viewer.server
    answer_request = viewer_server.request_share_url

    def noted() -> object:
        try:
            return answer_request()
        finally:
            asked.set()

    monkeypatch.setattr(viewer_server, "request_share_url", noted)
    with join(server, scene_id, origin=server.origin) as client:
        client.send(msgspec.msgpack.encode({"type": "ShareUrlRequest"}))
        assert asked.wait(10)
    assert tunnels == []


@pytest.mark.parametrize(
    ("body", "status", "code"),
    [
        ({"frame_index": 10, "identity_id": None}, 404, "frame_not_found"),  # the street has ten frames
        ({"frame_index": -1, "identity_id": None}, 422, "invalid_request"),
        ({"frame_index": 0, "theme": "pink"}, 422, "invalid_request"),
        ({}, 422, "invalid_request"),
    ],
)
def test_views_that_cannot_be(server: Any, body: dict[str, object], status: int, code: str) -> None:
    answer = httpx.put(f"{server.origin}/api/scenes/{open_scene(server)}/view", json=body)
    assert answer.status_code == status
    assert answer.json()["detail"]["code"] == code


def test_the_theme_stays_until_another_is_asked_for(server: Any) -> None:
    scene_id = open_scene(server, theme="light")
    scene = server.scenes.get(scene_id)
    url = f"{server.origin}/api/scenes/{scene_id}/view"
    assert httpx.put(url, json={"frame_index": 1, "identity_id": None}).status_code == 204
    assert scene.view.theme == "light"
    assert httpx.put(url, json={"frame_index": 1, "identity_id": None, "theme": "dark"}).status_code == 204
    assert scene.view.theme == "dark"
