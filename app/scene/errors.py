"""What can go wrong with a 3D view."""

from http import HTTPStatus

from app.errors import AppError


class SceneNotFound(AppError):
    """No open scene has that id: it was closed, or it never was."""

    status = HTTPStatus.NOT_FOUND
    code = "scene_not_found"


class FrameNotFound(AppError):
    """The drive has no frame of that index."""

    status = HTTPStatus.NOT_FOUND
    code = "frame_not_found"


class NoLidar(AppError):
    """A drive without LiDAR has nothing to show in 3D."""

    status = HTTPStatus.CONFLICT
    code = "no_lidar"


class ViewerFailed(AppError):
    """The 3D viewer could not be started safely."""

    status = HTTPStatus.INTERNAL_SERVER_ERROR
    code = "viewer_failed"
