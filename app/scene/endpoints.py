"""3D views over HTTP: open, move and close one, and its page and WebSocket under ``/scene/<id>/``."""

from typing import Annotated

from fastapi import APIRouter, Depends, Request, Response, WebSocket, status
from starlette.requests import HTTPConnection

from app.errors import error_response
from app.scene.errors import SceneNotFound
from app.scene.manager import SceneManager
from app.scene.page import page_headers, page_html
from app.scene.proxy import relay
from app.scene.schemas import SceneCreate, SceneOpened, SceneViewUpdate
from app.scene.types import SceneView

router = APIRouter(tags=["scene"])


def _scenes(connection: HTTPConnection) -> SceneManager:
    scenes: SceneManager = connection.app.state.scenes
    return scenes


Scenes = Annotated[SceneManager, Depends(_scenes)]


@router.post("/api/drives/{drive_id}/scenes", status_code=status.HTTP_201_CREATED)
def open_scene(drive_id: int, scenes: Scenes, start: SceneCreate | None = None) -> SceneOpened:
    """Open a 3D view of a drive."""
    scene_id = scenes.open(drive_id, (start or SceneCreate()).view())
    return SceneOpened(scene_id=scene_id, url=f"/scene/{scene_id}/")


@router.put("/api/scenes/{scene_id}/view", status_code=status.HTTP_204_NO_CONTENT)
def set_scene_view(scene_id: str, update: SceneViewUpdate, scenes: Scenes) -> None:
    """Move a 3D view to the playhead and highlight an identity. Answers at once; the last request wins."""
    scene = scenes.get(scene_id)
    theme = scene.view.theme if update.theme is None else update.theme
    scene.show(SceneView(frame_index=update.frame_index, identity_id=update.identity_id, theme=theme))


@router.delete("/api/scenes/{scene_id}", status_code=status.HTTP_204_NO_CONTENT)
def close_scene(scene_id: str, scenes: Scenes) -> None:
    """Close a 3D view. One that is closed already stays closed."""
    scenes.close_scene(scene_id)


@router.get("/scene/{scene_id}/", include_in_schema=False)
def get_scene_page(scene_id: str, scenes: Scenes, request: Request) -> Response:
    """The viewer's page, for a frame in the app's page."""
    scenes.get(scene_id)
    return Response(page_html(), media_type="text/html", headers=page_headers(request.headers["host"]))


@router.websocket("/scene/{scene_id}")
@router.websocket("/scene/{scene_id}/")
async def connect_scene(websocket: WebSocket, scene_id: str, scenes: Scenes) -> None:
    """The viewer's connection. Its page asks for it at its own address without the last slash."""
    try:
        scene = scenes.get(scene_id)
    except SceneNotFound as error:
        await websocket.send_denial_response(error_response(error.status, error.code, str(error)))
        return
    with scene.connection():
        await relay(websocket, scene.viewer)
