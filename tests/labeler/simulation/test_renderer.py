"""What the renderer draws, measured to the pixel. Needs OpenGL through EGL; Mesa's software renderer will do."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from labeler.geometry.se3 import se3
from labeler.simulation.errors import SimulationError
from labeler.simulation.graphics import open_context
from labeler.simulation.layout import TownLayout
from labeler.simulation.lighting import lighting_of
from labeler.simulation.materials import Material, Semantic
from labeler.simulation.meshes import Surface, box
from labeler.simulation.renderer import CameraView, Renderer, Rendering, VehicleInstance
from labeler.simulation.street_furniture import lamp_places_m, signal_mesh
from labeler.simulation.textures import Ink, Picture, TextureSet
from labeler.simulation.vehicles import VehicleModel
from labeler.simulation.world import Piece, SimulatedWorld

WIDTH_PX, HEIGHT_PX = 160, 80
FOCAL_PX = 80.0
INTRINSICS = np.array([[FOCAL_PX, 0, WIDTH_PX / 2], [0, FOCAL_PX, HEIGHT_PX / 2], [0, 0, 1]])
LOOKS_EAST = np.array([[0.0, 0, 1], [-1, 0, 0], [0, -1, 0]])
"""The rotation of a camera that looks along the world's x."""
GREY = Surface((0.4, 0.4, 0.4), Material.PAINT, paint=1.0)


def view_from(x_m: float, y_m: float, z_m: float) -> CameraView:
    return CameraView(se3(LOOKS_EAST, [x_m, y_m, z_m]), INTRINSICS)


def crate(length_m: float, width_m: float, height_m: float) -> VehicleModel:
    mesh = box((-length_m / 2, -width_m / 2, 0), (length_m / 2, width_m / 2, height_m), GREY)
    size_m = (length_m, width_m, height_m)
    return VehicleModel("crate", "car", size_m, (mesh, mesh, mesh), 1.0, -1.0, ((1.0, 1.0, 1.0),))


def at(instance_id: int, x_m: float, y_m: float, *, visible: bool = True) -> VehicleInstance:
    return VehicleInstance(instance_id, "crate", se3(np.eye(3), [x_m, y_m, 0.0]), (0.8, 0.1, 0.1), visible)


@pytest.fixture(scope="module")
def world() -> SimulatedWorld:
    """A town's signals on a bare plain; crates for vehicles."""
    layout = replace(TownLayout.generate(1, town="grid-small"), furniture=(), trees=(), lamps=())
    textures = TextureSet()
    textures.add(Picture((0, 1), (0, 1), Ink((255, 255, 255))))
    plain = box((-400, -400, -1), (400, 400, 0), Surface((0.1, 0.1, 0.1), Material.ASPHALT, rough=0.9))
    pieces = [Piece(plain, True, np.array([0.0, 0.0, -0.5]), 600.0)]
    for signal in layout.signals:
        place = np.array([signal.x_m, signal.y_m, 3.0])
        pieces.append(Piece(signal_mesh(signal), False, place, 10.0))
    return SimulatedWorld(layout, textures, {"crate": crate(4.0, 2.0, 1.5)}, tuple(pieces), {}, ())


@pytest.fixture(scope="module")
def renderer(world: SimulatedWorld) -> Renderer:
    try:
        open_context().release()
    except SimulationError as error:
        pytest.skip(f"no rendering here: {error}")
    return Renderer(world, WIDTH_PX, HEIGHT_PX)


def shot(renderer: Renderer, view: CameraView, *instances: VehicleInstance, light: str = "noon") -> Rendering:
    return renderer.render([view], instances, lighting_of(0, name=light), {})[0]


def pixels_of(mask: NDArray[np.bool_]) -> tuple[int, int, int, int]:
    rows, columns = np.nonzero(mask)
    return int(columns.min()), int(rows.min()), int(columns.max()) + 1, int(rows.max()) + 1


@pytest.mark.parametrize(
    ("x_m", "y_m", "eye_m", "expected"),
    [
        # near face 10 m ahead: 8 px a metre; 2 m wide about the middle; feet 1.8 m below the eye, top 0.3 m below
        (-88.0, -60.0, 1.8, (72, 42, 88, 54)),
        # the same, 3 m to the left: 24 px; its right side shows, whose far edge lies at 14 m
        (-88.0, -57.0, 1.8, (48, 42, 69, 54)),
        # from above: the far upper edge, 14 m ahead and 1.5 m below the eye, is higher in the image than the near one
        (-88.0, -60.0, 3.0, (72, 49, 88, 64)),
    ],
)
def test_ids_of_a_box_cover_its_projection_to_the_pixel(
    renderer: Renderer, x_m: float, y_m: float, eye_m: float, expected: tuple[int, int, int, int]
) -> None:
    view = view_from(-100.0, -60.0, eye_m)

    picture = shot(renderer, view, at(7, x_m, y_m))

    assert pixels_of(picture.ids == 7) == expected
    assert set(np.unique(picture.ids).tolist()) == {0, 7}


def test_depth_is_the_distance_along_the_optical_axis(renderer: Renderer) -> None:
    picture = shot(renderer, view_from(-100.0, -60.0, 1.8), at(7, -88.0, -60.0))

    # the box's near face is flat across the view
    np.testing.assert_allclose(picture.depth_m[44:52, 74:86], 10.0, atol=0.01)
    # row 70's middle lies 30.5 px below the horizon: the ground is 80 * 1.8 / 30.5 m away
    np.testing.assert_allclose(picture.depth_m[70, 10], FOCAL_PX * 1.8 / 30.5, rtol=1e-3)
    assert np.isinf(picture.depth_m[:20]).all()


def test_each_pixel_has_the_class_of_what_it_shows(renderer: Renderer) -> None:
    picture = shot(renderer, view_from(-100.0, -60.0, 1.8), at(7, -88.0, -60.0))

    assert (picture.semantic.dtype, picture.semantic.shape) == (np.uint8, (HEIGHT_PX, WIDTH_PX))
    # A crate's material is paint, which says nothing; it is a vehicle because it is drawn as one.
    np.testing.assert_array_equal(picture.semantic == Semantic.VEHICLE, picture.ids == 7)
    assert set(np.unique(picture.semantic[60:]).tolist()) == {Semantic.ROAD}  # the plain is of asphalt
    assert set(np.unique(picture.semantic[:20]).tolist()) == {Semantic.OTHER}  # sky


def test_the_nearer_of_two_hides_the_other(renderer: Renderer) -> None:
    view = view_from(-100.0, -60.0, 1.0)  # lower than the crates are high

    picture = shot(renderer, view, at(3, -88.0, -60.0), at(4, -70.0, -60.0))
    alone = shot(renderer, view, at(4, -70.0, -60.0))

    assert (alone.ids == 4).sum() > 0
    assert (picture.ids == 4).sum() == 0
    assert pixels_of(picture.ids == 3) == (72, 36, 88, 48)  # from half a metre above the eye to a metre below


def test_large_ids_survive(renderer: Renderer) -> None:
    picture = shot(renderer, view_from(-100.0, -60.0, 1.8), at(16_777_215, -88.0, -60.0))

    assert picture.ids.max() == 16_777_215
    assert picture.ids.dtype == np.int32
    assert set(np.unique(picture.semantic[picture.ids > 0]).tolist()) == {Semantic.VEHICLE}


def test_the_same_view_twice_is_the_same_to_the_byte(renderer: Renderer) -> None:
    view = view_from(-100.0, -60.0, 1.8)
    first = shot(renderer, view, at(3, -88.0, -61.0))
    shot(renderer, view_from(-90.0, 20.0, 4.0), at(5, -70.0, 21.0), light="evening")
    again = shot(renderer, view, at(3, -88.0, -61.0))

    assert first.image.tobytes() == again.image.tobytes()
    assert first.ids.tobytes() == again.ids.tobytes()
    assert first.depth_m.tobytes() == again.depth_m.tobytes()


def test_a_second_renderer_draws_the_same_bytes(renderer: Renderer, world: SimulatedWorld) -> None:
    view = view_from(-100.0, -60.0, 1.8)
    first = shot(renderer, view, at(3, -88.0, -61.0))
    second = shot(Renderer(world, WIDTH_PX, HEIGHT_PX), view, at(3, -88.0, -61.0))

    assert first.image.tobytes() == second.image.tobytes()


def test_a_vehicle_throws_a_shadow_away_from_the_sun_even_when_it_is_not_seen(renderer: Renderer) -> None:
    light = replace(lighting_of(0, name="noon"), azimuth_rad=np.pi / 2, elevation_rad=np.radians(35.0))
    view = view_from(-100.0, -60.0, 6.0)
    seen, unseen = (
        renderer.render([view], [at(3, -88.0, -60.0, visible=visible)], light, {})[0] for visible in (True, False)
    )
    bare = renderer.render([view], [], light, {})[0]

    assert (unseen.ids == 0).all()
    darker = bare.image.sum(axis=2).astype(int) - unseen.image.sum(axis=2).astype(int) > 30
    # the sun stands in the north, to the left: a top edge 1.5 m high throws its shadow 2.1 m to the south, to the right
    x0, _, x1, _ = pixels_of(darker)
    assert x0 < 80 < x1
    assert darker[:, 92:].sum() > 3 * darker[:, :68].sum()
    assert (seen.ids == 3).any()


def test_signals_show_their_phase(renderer: Renderer, world: SimulatedWorld) -> None:
    signal = next(s for s in world.layout.signals if s.approach == 0)
    x_m, y_m, z_m = signal.heads_m[0]
    view = CameraView(se3(LOOKS_EAST, [x_m - 3.0, y_m, z_m + 0.32]), INTRINSICS)
    key = (signal.junction_id, signal.approach)
    brightness: dict[str, dict[str, float]] = {}
    for state in ("red", "yellow", "green"):
        picture = renderer.render([view], [], lighting_of(0, name="noon"), {key: state})[0]
        brightness[state] = {}
        for (lamp_x, lamp_y, lamp_z), color in lamp_places_m(signal)[:3]:
            assert lamp_y == pytest.approx(y_m)
            row = int(HEIGHT_PX / 2 - FOCAL_PX * (lamp_z - z_m - 0.32) / (lamp_x - x_m + 3.0))
            brightness[state][color] = float(picture.image[row, WIDTH_PX // 2].max())
    for state, lamps in brightness.items():
        assert max(lamps, key=lambda color: lamps[color]) == state
        assert lamps[state] > 200
        assert sorted(lamps.values())[1] < 100
    assert renderer.render([view], [], lighting_of(0, name="noon"), {})[0].image.tobytes() == (
        renderer.render([view], [], lighting_of(0, name="noon"), {key: "red"})[0].image.tobytes()
    )


def test_a_vehicle_takes_its_paint(renderer: Renderer) -> None:
    picture = shot(renderer, view_from(-100.0, -60.0, 1.8), at(7, -88.0, -60.0), light="overcast")

    blue, green, red = picture.image[picture.ids == 7].mean(axis=0)
    assert red > 1.5 * green
    assert red > 1.5 * blue


def test_a_small_town_from_code_has_everything_in_it() -> None:
    world = SimulatedWorld.build(2, town="grid-small", blocks=(1, 1))
    position_m, faces, material = world.static_triangles()

    assert faces.max() < len(position_m)
    assert len(material) == len(faces)
    solid = {Material.ASPHALT, Material.MARKING, Material.PAVING, Material.GRASS, Material.WALL, Material.FOLIAGE}
    assert solid <= set(material.tolist())
    # a plumb line hits the street at z = 0 and the sidewalk 15 cm above it
    assert position_m[:, 2].min() == 0.0
    street = position_m[faces[material == Material.ASPHALT]]
    np.testing.assert_array_equal(street[..., 2], 0.0)
    assert {prop.model for prop in world.props} <= set(world.prop_models)
