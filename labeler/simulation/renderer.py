"""Pictures of a simulated world: what a camera sees, which vehicle each pixel shows, and how far away it is.

Everything that can be seen is first drawn as depth alone, then in colour where it is the nearest, so that no hidden
pixel is shaded. The sun's shadows come from two depth maps seen from the sun, a fine one around the middle of the views
and a coarse one around that. Colour has four samples a pixel, ids and depth one, at the pixel's centre.

Anisotropic filtering stays off: Mesa's software renderer takes minutes a frame with it.
"""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from labeler.geometry.se3 import invert_se3
from labeler.simulation import shaders
from labeler.simulation.graphics import Drawable, Uniform, instance_row, open_context, set_uniforms
from labeler.simulation.layout import Approach, JunctionId
from labeler.simulation.lighting import Lighting
from labeler.simulation.materials import Material
from labeler.simulation.meshes import Mesh, Surface, quad
from labeler.simulation.projection import (
    camera_projection,
    depth_of,
    frustum_planes,
    in_frustum,
    in_sun_map,
    sun_projection,
)
from labeler.simulation.street_furniture import lamp_disc, lamp_places_m
from labeler.simulation.textures import LAYER_PX, tileable_noise
from labeler.simulation.world import SimulatedWorld

SignalState = Literal["green", "yellow", "red", "off"]
SignalStates = Mapping[tuple[JunctionId, Approach], SignalState]
"""What each approach's signal shows; approaches that are left out show red."""

_DETAIL_UNTIL_M = (15.0, 40.0)
_PROP_DETAIL_UNTIL_M = (38.0,)
_SEEN_UNTIL_M = 260.0
_SHADOW_PX = (2048, 1536)
_SHADOW_REACH_M = (42.0, 150.0)
_SAMPLES = 4
_NOISE_PX = 512
_LAMP_GLOW = {"green": (0.05, 1.5, 0.45), "yellow": (2.2, 1.1, 0.06), "red": (2.4, 0.10, 0.06)}
_LAMP_DARK = {"green": (0.004, 0.03, 0.012), "yellow": (0.04, 0.025, 0.004), "red": (0.045, 0.005, 0.004)}

_STILL = instance_row(np.eye(4))[None]
_DEPTH_TEST, _BLEND = 2, 1  # moderngl's flags, whose module is loaded only when a context is opened
_LINEAR, _LINEAR_MIPMAP_LINEAR = 0x2601, 0x2703
_MULTIPLY = (0x0306, 0x0000)  # what is there times what is drawn, and nothing added


@dataclass(frozen=True, eq=False)
class CameraView:
    """One camera at one moment. ``world_SE3_camera`` is (4, 4) with the camera's x to the right, y down and z forward;
    ``intrinsics`` (3, 3) in pixels, counted from the image's upper left corner."""

    world_SE3_camera: NDArray[np.float64]
    intrinsics: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class VehicleInstance:
    """A vehicle at one moment. ``model`` names one of the world's models, ``world_SE3_vehicle`` (4, 4) places it,
    ``paint`` is linear RGB. ``instance_id`` is from 1 to 16,777,215, or 0 for none. One that is not ``visible``, such
    as the ego car, still throws its shadow."""

    instance_id: int
    model: str
    world_SE3_vehicle: NDArray[np.float64]
    paint: tuple[float, float, float]
    visible: bool = True


@dataclass(frozen=True, eq=False)
class Rendering:
    """One view: ``image`` (H, W, 3) uint8 BGR; ``ids`` (H, W) int32, the vehicle's id or 0; ``semantic`` (H, W) uint8,
    a ``Semantic`` of each pixel; ``depth_m`` (H, W) float32 along the optical axis, infinite where the sky is."""

    image: NDArray[np.uint8]
    ids: NDArray[np.int32]
    semantic: NDArray[np.uint8]
    depth_m: NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class _Static:
    drawable: Drawable
    is_ground: bool
    center_m: NDArray[np.float64]
    radius_m: float


@dataclass(frozen=True, eq=False)
class _Placed:
    """Copies of one mesh with levels of detail, each used up to a distance of ``until_m``: (N, 16) rows, (N, 3) centres
    and (N,) radii."""

    details: tuple[Drawable, ...]
    rows: NDArray[np.float32]
    center_m: NDArray[np.float64]
    radius_m: NDArray[np.float64]
    until_m: tuple[float, ...]


class Renderer:
    """Draws a world with a fixed image size. Open it once: it holds the world in the graphics card's memory.

    The same call gives the same bytes on one machine. SimulationError when there is no OpenGL."""

    def __init__(self, world: SimulatedWorld, width_px: int, height_px: int) -> None:
        self._world = world
        self._size_px = (width_px, height_px)
        self._context = context = open_context()
        self._programs = {
            name: context.program(vertex_shader=shaders.VERTEX, fragment_shader=source)
            for name, source in (
                ("depth", shaders.DEPTH), ("identity", shaders.IDENTITY), ("standing", shaders.STANDING),
                ("ground", shaders.GROUND), ("contact", shaders.CONTACT),
            )
        }  # fmt: skip
        self._programs["sky"] = context.program(vertex_shader=shaders.SKY_VERTEX, fragment_shader=shaders.SKY)
        self._textures = [self._layers(world.textures.color, 4), self._layers(world.textures.surface, 3)]
        self._noise = self._noise_texture(world.layout.seed)
        self._shadows = [self._shadow_map(size) for size in _SHADOW_PX]
        self._canvas = context.framebuffer(
            [context.renderbuffer(self._size_px, 4, samples=_SAMPLES)],
            context.depth_renderbuffer(self._size_px, samples=_SAMPLES),
        )
        self._flat_canvas = context.framebuffer([context.renderbuffer(self._size_px, 4)])
        self._id_texture = context.texture(self._size_px, 1, dtype="u4")
        self._depth_texture = context.depth_texture(self._size_px)
        self._id_canvas = context.framebuffer([self._id_texture], self._depth_texture)
        corners = context.buffer(np.array([-1, -1, 3, -1, -1, 3], dtype=np.float32).tobytes())
        self._sky = context.vertex_array(self._programs["sky"], [(corners, "2f", "in_corner")])
        self._statics = [_Static(Drawable(context, p.mesh), p.is_ground, p.center_m, p.radius_m) for p in world.pieces]
        self._props = self._place_props()
        self._models = {
            name: tuple(Drawable(context, mesh) for mesh in model.details) for name, model in world.models.items()
        }
        self._lamp_disc = Drawable(context, lamp_disc())
        self._contacts = {name: Drawable(context, _contact(model.size_m)) for name, model in world.models.items()}

    def close(self) -> None:
        """Give the graphics memory back, half a gigabyte without a graphics card. Nothing can be rendered after it."""
        self._context.release()

    def render(
        self, views: Sequence[CameraView], instances: Sequence[VehicleInstance], lighting: Lighting,
        signal_states: SignalStates,
    ) -> list[Rendering]:  # fmt: skip
        """What each camera sees of the vehicles at one moment, in the order of ``views``."""
        middle = np.mean([view.world_SE3_camera[:3, 3] for view in views], axis=0)
        shadowed = self._place_vehicles(instances)
        visible = [*self._place_vehicles([i for i in instances if i.visible]), self._place_lamps(signal_states)]
        suns = self._draw_shadows([*shadowed, *self._props], middle, lighting)
        common: dict[str, Uniform] = {
            "near_sun": suns[0], "far_sun": suns[1], "colors": 0, "surfaces": 1, "near_shadow": 2, "far_shadow": 3,
            "noise": 4, "sun_direction": lighting.sun_direction, "sun": lighting.sun, "zenith": lighting.zenith,
            "horizon": lighting.horizon, "above": lighting.above, "below": lighting.below, "haze": lighting.haze_per_m,
            "clouds": lighting.clouds, "exposure": lighting.exposure,
        }  # fmt: skip
        return [self._render_view(view, visible, instances, common) for view in views]

    def _render_view(
        self,
        view: CameraView,
        vehicles: list[_Placed],
        instances: Sequence[VehicleInstance],
        common: dict[str, Uniform],
    ) -> Rendering:
        eye = view.world_SE3_camera[:3, 3]
        camera_SE3_world = invert_se3(view.world_SE3_camera)
        projection = camera_projection(view.intrinsics, *self._size_px) @ camera_SE3_world
        planes = frustum_planes(projection)
        uniforms: dict[str, Uniform] = {
            **common,
            "view_projection": projection,
            "inverse_view_projection": np.linalg.inv(projection),
            "eye": eye,
        }
        for program in self._programs.values():
            set_uniforms(program, uniforms)
        for unit, texture in enumerate((*self._textures, self._shadows[0][0], self._shadows[1][0], self._noise)):
            texture.use(unit)
        statics = [s for s in self._statics if in_frustum(planes, s.center_m[None], s.radius_m)[0]]
        placed = [batch for group in (*vehicles, *self._props) for batch in _seen(group, planes, eye)]
        image = self._draw_colors(statics, placed, instances)
        return Rendering(image, *self._draw_ids(statics, placed))

    def _draw_colors(
        self, statics: list[_Static], placed: list[tuple[Drawable, NDArray[np.float32]]],
        instances: Sequence[VehicleInstance],
    ) -> NDArray[np.uint8]:  # fmt: skip
        context, programs, still = self._context, self._programs, _STILL
        self._canvas.use()
        self._canvas.clear(0.0, 0.0, 0.0, 1.0, depth=1.0)
        context.enable_only(_DEPTH_TEST)
        context.depth_func = "<"
        for static in statics:
            static.drawable.draw(programs["depth"], still)
        for drawable, rows in placed:
            drawable.draw(programs["depth"], rows)
        self._canvas.depth_mask = False
        context.depth_func = "=="
        for static in statics:
            static.drawable.draw(programs["ground" if static.is_ground else "standing"], still)
        for drawable, rows in placed:
            drawable.draw(programs["standing"], rows)
        context.depth_func = "<="
        context.enable_only(_DEPTH_TEST | _BLEND)
        context.blend_func = _MULTIPLY
        for instance in instances:
            self._contacts[instance.model].draw(programs["contact"], instance_row(instance.world_SE3_vehicle)[None])
        context.enable_only(_DEPTH_TEST)
        self._sky.render()
        self._canvas.depth_mask = True
        context.copy_framebuffer(self._flat_canvas, self._canvas)
        width_px, height_px = self._size_px
        pixels = np.frombuffer(self._flat_canvas.read(components=3, alignment=1), dtype=np.uint8)
        return np.ascontiguousarray(pixels.reshape(height_px, width_px, 3)[::-1, :, ::-1])

    def _draw_ids(
        self, statics: list[_Static], placed: list[tuple[Drawable, NDArray[np.float32]]]
    ) -> tuple[NDArray[np.int32], NDArray[np.uint8], NDArray[np.float32]]:
        """The ids, the semantic classes and the depth of a view."""
        self._context.depth_func = "<"
        self._id_canvas.use()
        self._id_canvas.clear(0.0, 0.0, 0.0, 0.0, depth=1.0)
        for static in statics:
            static.drawable.draw(self._programs["identity"], _STILL)
        for drawable, rows in placed:
            drawable.draw(self._programs["identity"], rows)
        width_px, height_px = self._size_px
        drawn = np.frombuffer(self._id_texture.read(alignment=1), dtype=np.uint32).reshape(height_px, width_px)[::-1]
        depth = np.frombuffer(self._depth_texture.read(alignment=1), dtype=np.float32).reshape(height_px, width_px)
        ids, semantic = (drawn & 0xFFFFFF).astype(np.int32), (drawn >> 24).astype(np.uint8)
        return ids, semantic, np.ascontiguousarray(depth_of(depth)[::-1])

    def _draw_shadows(
        self, placed: list[_Placed], middle: NDArray[np.float64], lighting: Lighting
    ) -> list[NDArray[np.float64]]:
        """Fills both depth maps seen from the sun and returns the matrices that lead to them."""
        matrices: list[NDArray[np.float64]] = []
        program = self._programs["depth"]
        self._context.enable_only(_DEPTH_TEST)
        self._context.depth_func = "<"
        self._textures[0].use(0)
        for (_, canvas), size_px, reach_m, detail in zip(
            self._shadows, _SHADOW_PX, _SHADOW_REACH_M, (1, 2), strict=True
        ):
            matrix = sun_projection(lighting.sun_direction, middle, reach_m, size_px)
            matrices.append(matrix)
            canvas.use()
            canvas.clear(depth=1.0)
            set_uniforms(program, {"view_projection": matrix, "colors": 0})
            for static in self._statics:
                if not static.is_ground and in_sun_map(matrix, static.center_m[None], static.radius_m, reach_m)[0]:
                    static.drawable.draw(program, _STILL)
            for group in placed:
                chosen = in_sun_map(matrix, group.center_m, group.radius_m, reach_m)
                if chosen.any():
                    group.details[min(detail, len(group.details) - 1)].draw(program, group.rows[chosen])
        return matrices

    def _place_vehicles(self, instances: Sequence[VehicleInstance]) -> list[_Placed]:
        groups: dict[str, list[VehicleInstance]] = defaultdict(list)
        for instance in instances:
            groups[instance.model].append(instance)
        return [
            _Placed(
                self._models[name],
                np.stack([instance_row(i.world_SE3_vehicle, i.paint, i.instance_id) for i in group]),
                np.stack([i.world_SE3_vehicle[:3, 3] for i in group]),
                np.full(len(group), float(np.linalg.norm(self._world.models[name].size_m))),
                _DETAIL_UNTIL_M,
            )
            for name, group in sorted(groups.items())
        ]

    def _place_lamps(self, states: SignalStates) -> _Placed:
        rows: list[NDArray[np.float32]] = []
        centers: list[tuple[float, float, float]] = []
        for signal in self._world.layout.signals:
            state = states.get((signal.junction_id, signal.approach), "red")
            cos, sin = np.cos(signal.heading_rad), np.sin(signal.heading_rad)
            for place_m, color in lamp_places_m(signal):
                matrix = np.array([[cos, -sin, 0, place_m[0]], [sin, cos, 0, place_m[1]], [0, 0, 1, place_m[2]]])
                rows.append(instance_row(matrix, _LAMP_GLOW[color] if color == state else _LAMP_DARK[color]))
                centers.append(place_m)
        rows_array = np.stack(rows) if rows else np.empty((0, 16), dtype=np.float32)
        return _Placed((self._lamp_disc,), rows_array, np.array(centers).reshape(-1, 3), np.full(len(rows), 0.2), ())

    def _place_props(self) -> list[_Placed]:
        placed: list[_Placed] = []
        for name, model in self._world.prop_models.items():
            props = [prop for prop in self._world.props if prop.model == name]
            if not props:
                continue
            low, high = model.details[0].bounds_m
            reach = float(np.linalg.norm(np.maximum(np.abs(low), np.abs(high))))
            placed.append(
                _Placed(
                    tuple(Drawable(self._context, mesh) for mesh in model.details),
                    np.stack([instance_row(prop.matrix) for prop in props]),
                    np.array([prop.position_m for prop in props]),
                    np.array([reach * prop.scale for prop in props]),
                    _PROP_DETAIL_UNTIL_M,
                )
            )
        return placed

    def _layers(self, images: Sequence[NDArray[np.uint8]], components: int) -> Any:
        size = (LAYER_PX, LAYER_PX, len(images))
        texture = self._context.texture_array(size, components, np.stack(images).tobytes(), alignment=1)
        texture.build_mipmaps()
        texture.filter = (_LINEAR_MIPMAP_LINEAR, _LINEAR)
        return texture

    def _noise_texture(self, seed: int) -> Any:
        rng = np.random.default_rng([seed, 7])
        octaves = ((4, 8, 16, 32), (64, 128, 256), (8, 16, 32, 64), (256, 512))
        noise = np.stack([tileable_noise(rng, _NOISE_PX, cells) for cells in octaves], axis=-1)
        pixels = np.round(noise * 255).astype(np.uint8)
        texture = self._context.texture((_NOISE_PX, _NOISE_PX), 4, pixels.tobytes())
        texture.build_mipmaps()
        texture.filter = (_LINEAR_MIPMAP_LINEAR, _LINEAR)
        return texture

    def _shadow_map(self, size_px: int) -> tuple[Any, Any]:
        depth = self._context.depth_texture((size_px, size_px))
        depth.compare_func = "<="
        depth.filter = (_LINEAR, _LINEAR)
        depth.repeat_x = depth.repeat_y = False
        return depth, self._context.framebuffer(depth_attachment=depth)


def _seen(
    group: _Placed, planes: NDArray[np.float64], eye: NDArray[np.float64]
) -> list[tuple[Drawable, NDArray[np.float32]]]:
    """Those of a group that a camera may see, by level of detail."""
    distance_m = np.linalg.norm(group.center_m - eye, axis=1)
    visible = in_frustum(planes, group.center_m, group.radius_m) & (distance_m < _SEEN_UNTIL_M)
    passed = distance_m[:, None] >= np.array(group.until_m)[None]
    detail = passed.sum(axis=1).clip(max=len(group.details) - 1)
    batches = [(drawable, group.rows[visible & (detail == level)]) for level, drawable in enumerate(group.details)]
    return [(drawable, rows) for drawable, rows in batches if len(rows)]


def _contact(size_m: tuple[float, float, float]) -> Mesh:
    """A patch on the ground that darkens it under and around a vehicle; texture places are metres from its middle."""
    half_x, half_y = size_m[0] / 2 - 0.1, size_m[1] / 2 - 0.2
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (half_x + 0.6, half_y + 0.6)
    surface = Surface((0.0, 0.0, 0.0), Material.ASPHALT, paint=half_x, metal=half_y)
    return quad(np.column_stack([corners, np.full(4, 0.015)]), surface, uv=corners)
