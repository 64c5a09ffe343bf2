"""What the page sends and gets about 3D views."""

from pydantic import BaseModel, Field

from app.scene.types import SceneView, Theme


class SceneCreate(BaseModel):
    """How the view starts; everything has a default."""

    frame_index: int = Field(default=0, ge=0)
    identity_id: int | None = None
    theme: Theme = Theme.DARK

    def view(self) -> SceneView:
        return SceneView(frame_index=self.frame_index, identity_id=self.identity_id, theme=self.theme)


class SceneOpened(BaseModel):
    """An open 3D view and where its page lies."""

    scene_id: str
    url: str


class SceneViewUpdate(BaseModel):
    """Where the playhead stands and which identity is selected. Without a theme, it stays as it is."""

    frame_index: int = Field(ge=0)
    identity_id: int | None = None
    theme: Theme | None = None
