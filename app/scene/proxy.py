"""Carries a browser's WebSocket to a private viewer and back, message by message.

Both ways wait for the receiver, so a slow page slows the viewer down instead of filling memory.
"""

from __future__ import annotations

import asyncio
import contextlib

from starlette.websockets import WebSocket, WebSocketDisconnect, WebSocketState
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed
from websockets.typing import Subprotocol

from app.scene.viewer import KEY_HEADER, PrivateViewer

_NOT_SENDABLE = {1005: 1000, 1006: 1011, 1015: 1011}  # codes that only report, and what is sent for them


async def relay(browser: WebSocket, viewer: PrivateViewer) -> None:
    """Connect a browser to a viewer until either leaves; the other gets the same close code.

    The browser's connection must not be accepted yet. OSError when the viewer is gone."""
    offered = [Subprotocol(protocol) for protocol in browser.scope["subprotocols"]]
    async with connect(
        viewer.url,
        subprotocols=offered or None,
        additional_headers={KEY_HEADER: viewer.key},
        compression=None,  # both ends are on this machine
        max_size=None,  # the viewer is ours, and uvicorn limits what the browser sends
        proxy=None,  # loopback, whatever the environment says
        ping_interval=None,
    ) as upstream:
        await browser.accept(subprotocol=upstream.subprotocol)
        directions = {
            asyncio.create_task(_browser_to_viewer(browser, upstream)),
            asyncio.create_task(_viewer_to_browser(upstream, browser)),
        }
        try:
            done, _ = await asyncio.wait(directions, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for task in directions:
                task.cancel()
            await asyncio.gather(*directions, return_exceptions=True)
        for task in done:
            task.result()


async def _browser_to_viewer(browser: WebSocket, upstream: ClientConnection) -> None:
    try:
        while True:
            message = await browser.receive()
            if message["type"] == "websocket.disconnect":
                await upstream.close(_sendable(message.get("code", 1005)), message.get("reason") or "")
                return
            data = message.get("bytes")
            await upstream.send(message["text"] if data is None else data)
    except ConnectionClosed:
        await _close_browser(browser, upstream)


async def _viewer_to_browser(upstream: ClientConnection, browser: WebSocket) -> None:
    try:
        async for data in upstream:
            if isinstance(data, bytes):
                await browser.send_bytes(data)
            else:
                await browser.send_text(data)
    except WebSocketDisconnect:  # the page left while a message was on its way
        return
    except ConnectionClosed:  # an abrupt end; the close code says which
        pass
    await _close_browser(browser, upstream)


async def _close_browser(browser: WebSocket, upstream: ClientConnection) -> None:
    if browser.application_state is not WebSocketState.CONNECTED:
        return
    code = _sendable(upstream.close_code or 1006)
    with contextlib.suppress(RuntimeError, WebSocketDisconnect):  # it may leave at this very moment
        await browser.close(code, upstream.close_reason or "")


def _sendable(code: int) -> int:
    return _NOT_SENDABLE.get(code, code)
