"""Draws a view on a viser server: points, boxes, cameras, the car and the ground, all in the ego frame.

Nodes keep their names, so drawing again replaces what stood there; a view is drawn as one step for the browser.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import viser
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from app.scene.palette import Rgb, ScenePalette, faded, identity_color, point_colors, scene_palette
from app.scene.shapes import LINES_PER_BOX, PointCloud, box_corners, box_lines, unit_cube
from app.scene.tone import line_colors
from app.scene.types import SceneBox, SceneView, Theme
from labeler.drive.types import Camera

_LINE_PX = 2.0
_SELECTED_LINE_PX = 5.0
_POINT_SIZE_M = 0.055
_FRUSTUM_SCALE_M = 1.4
_CAMERA_NAME_AHEAD_M = 3.0
_EGO_SIZE_M = (4.6, 1.9, 1.5)  # a usual car: the drive does not say how large its own is
_EGO_CENTER_AHEAD_M = 1.3  # the ego frame stands on the rear axle
_CAMERA_POSITION_M = (-14.0, 0.0, 9.0)
_CAMERA_LOOK_AT_M = (12.0, 0.0, -1.0)
_CAMERA_FOV_RAD = 0.9


class SceneCanvas:
    """The content of one viser server. Not thread-safe: one thread draws."""

    def __init__(self, server: viser.ViserServer, cameras: Sequence[Camera]) -> None:
        self._server = server
        self._cameras = tuple(camera for camera in cameras if camera.calibration is not None)
        self._theme: Theme | None = None
        self._ground_m: float | None = None
        server.initial_camera.position = _CAMERA_POSITION_M
        server.initial_camera.look_at = _CAMERA_LOOK_AT_M
        server.initial_camera.fov = _CAMERA_FOV_RAD
        server.scene.world_axes.visible = False

    def draw(self, view: SceneView, points: PointCloud, boxes: Sequence[SceneBox], *, ground_m: float) -> None:
        """Show this view. ``ground_m`` is the road's height in the ego frame; the first one stays, so that the grid
        does not tremble from frame to frame.
        """
        palette = scene_palette(view.theme)
        with self._server.atomic():
            if self._theme is not view.theme or self._ground_m is None:
                self._theme = view.theme
                self._ground_m = ground_m if self._ground_m is None else self._ground_m
                self._draw_surroundings(palette, self._ground_m)
            self._draw_points(points, palette, self._ground_m)
            self._draw_boxes(boxes, view)
        self._server.flush()

    def _draw_surroundings(self, palette: ScenePalette, ground_m: float) -> None:
        self._server.gui.configure_theme(dark_mode=self._theme is Theme.DARK, show_logo=False, show_share_button=False)
        self._server.scene.add_grid(
            "/ground",
            width=240.0,
            height=240.0,
            cell_size=10.0,
            section_size=50.0,
            cell_color=palette.grid,
            section_color=palette.grid_section,
            shadow_opacity=0.0,
            position=(0.0, 0.0, ground_m),
        )
        self._draw_ego(palette, ground_m)
        for camera in self._cameras:
            self._draw_camera(camera, palette)

    def _draw_ego(self, palette: ScenePalette, ground_m: float) -> None:
        ego = SceneBox(
            center_m=(_EGO_CENTER_AHEAD_M, 0.0, ground_m + _EGO_SIZE_M[2] / 2),
            size_m=_EGO_SIZE_M,
            yaw_rad=0.0,
            identity_id=None,
            class_name="ego",
            score=None,
        )
        self._draw_lines("/ego/edges", [ego], [palette.ego], _LINE_PX)
        self._draw_faces("/ego/faces", [ego], [palette.ego], opacity=0.25)

    def _draw_camera(self, camera: Camera, palette: ScenePalette) -> None:
        calibration = camera.calibration
        if calibration is None:
            return
        quaternion = Rotation.from_matrix(calibration.ego_SE3_camera[:3, :3]).as_quat(scalar_first=True)
        position = calibration.ego_SE3_camera[:3, 3]
        self._server.scene.add_camera_frustum(
            f"/cameras/{camera.name}",
            fov=float(2 * np.arctan2(camera.height_px / 2, calibration.intrinsics[1, 1])),
            aspect=camera.width_px / camera.height_px,
            scale=_FRUSTUM_SCALE_M,
            thickness=1.5,
            thickness_units="screen",
            color=palette.camera,
            wxyz=quaternion,
            position=position,
            cast_shadow=False,
            receive_shadow=False,
        )
        ahead_m = calibration.ego_SE3_camera[:3, 2] * _CAMERA_NAME_AHEAD_M
        self._server.scene.add_label(
            f"/camera_names/{camera.name}",
            camera.name,
            position=position + ahead_m,
            font_screen_scale=0.75,
            anchor="bottom-center",
        )

    def _draw_points(self, points: PointCloud, palette: ScenePalette, ground_m: float) -> None:
        self._server.scene.add_point_cloud(
            "/sweep",
            points.xyz_m,
            point_colors(points.xyz_m[:, 2] - np.float32(ground_m), points.reflectance, palette),
            point_size=_POINT_SIZE_M,
            point_shape="circle",
            point_shading="flat",
            precision="float32",
        )

    def _draw_boxes(self, boxes: Sequence[SceneBox], view: SceneView) -> None:
        selected = [box for box in boxes if view.identity_id is not None and box.identity_id == view.identity_id]
        others = [box for box in boxes if view.identity_id is None or box.identity_id != view.identity_id]
        colors = [_color_of(box, view) for box in others]
        if selected:
            colors = [faded(color, scene_palette(view.theme).background) for color in colors]
        self._draw_group("/boxes", others, colors, line_px=_LINE_PX, opacity=0.12)
        colors = [_color_of(box, view) for box in selected]
        self._draw_group("/selected", selected, colors, line_px=_SELECTED_LINE_PX, opacity=0.4)
        self._draw_selected_label(selected)

    def _draw_group(
        self, name: str, boxes: Sequence[SceneBox], colors: Sequence[Rgb], *, line_px: float, opacity: float
    ) -> None:
        if not boxes:
            self._server.scene.remove_by_name(name)
            return
        self._draw_lines(f"{name}/edges", boxes, colors, line_px)
        self._draw_faces(f"{name}/faces", boxes, colors, opacity=opacity)

    def _draw_lines(self, name: str, boxes: Sequence[SceneBox], colors: Sequence[Rgb], line_px: float) -> None:
        ends = np.repeat(line_colors(_as_array(colors)), LINES_PER_BOX, axis=0)[:, None].repeat(2, axis=1)
        self._server.scene.add_line_segments(
            name, box_lines(box_corners(boxes)), ends, thickness=line_px, thickness_units="screen"
        )

    def _draw_faces(self, name: str, boxes: Sequence[SceneBox], colors: Sequence[Rgb], *, opacity: float) -> None:
        vertices, faces = unit_cube()
        half_yaw = np.array([box.yaw_rad for box in boxes]) / 2
        none = np.zeros(len(boxes))
        self._server.scene.add_batched_meshes_simple(
            name,
            vertices,
            faces,
            batched_wxyzs=np.stack([np.cos(half_yaw), none, none, np.sin(half_yaw)], axis=1),
            batched_positions=np.array([box.center_m for box in boxes], dtype=np.float32),
            batched_scales=np.array([box.size_m for box in boxes], dtype=np.float32),
            batched_colors=_as_array(colors),
            opacity=opacity,
            flat_shading=True,
            side="double",
            lod="off",
            cast_shadow=False,
            receive_shadow=False,
        )

    def _draw_selected_label(self, selected: Sequence[SceneBox]) -> None:
        if not selected:
            self._server.scene.remove_by_name("/selected_label")
            return
        best = max(selected, key=lambda box: -1.0 if box.score is None else box.score)
        x, y, z = best.center_m
        self._server.scene.add_label(
            "/selected_label",
            label_text(best),
            position=(x, y, z + best.size_m[2] / 2 + 0.3),
            anchor="bottom-center",
        )


def label_text(box: SceneBox) -> str:
    """What stands above the selected box: identity, class and score where known."""
    identity = "" if box.identity_id is None else f"#{box.identity_id} "
    score = "" if box.score is None else f" {box.score:.2f}"
    return f"{identity}{box.class_name}{score}"


def _color_of(box: SceneBox, view: SceneView) -> Rgb:
    if box.identity_id is None:
        return scene_palette(view.theme).unknown_box
    return identity_color(box.identity_id, view.theme)


def _as_array(colors: Sequence[Rgb]) -> NDArray[np.uint8]:
    return np.array(colors, dtype=np.uint8).reshape(-1, 3)
