"""The few things the renderer needs from OpenGL, through moderngl: a context without a window, meshes in the graphics
card's memory that are drawn many times at once, and uniforms by name.

moderngl belongs to the extra ``simulation`` and is loaded here only, when a context is opened.
"""

from collections.abc import Mapping
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from labeler.simulation.errors import SimulationError
from labeler.simulation.meshes import Mesh

_VERTEX_INPUTS = (
    ("in_position", 3), ("in_normal", 3), ("in_uv", 2), ("in_layer", 1), ("in_color", 3), ("in_surface", 4),
    ("in_shading", 1), ("in_semantic", 1),
)  # fmt: skip
_INSTANCE_INPUTS = (("in_row0", 4), ("in_row1", 4), ("in_row2", 4), ("in_paint_id", 4))
INSTANCE_FLOATS = 16
"""Floats of one instance: three rows of its model matrix, its paint and its id."""


def open_context() -> Any:
    """A moderngl context through EGL, which needs no display. SimulationError says what to install when there is
    none."""
    try:
        moderngl: Any = import_module("moderngl")
    except ImportError as error:
        raise SimulationError(
            "rendering needs moderngl, which is not installed: pip install 'hindsight-labeler[simulation]'"
        ) from error
    try:
        return moderngl.create_standalone_context(backend="egl")
    except Exception as error:  # moderngl raises bare Exceptions, and OSErrors for missing libraries
        raise SimulationError(
            f"rendering needs OpenGL 3.3 through EGL, and none could be opened ({error}). A graphics card is not "
            "needed; on Debian or Ubuntu: apt-get install libegl1 libgl1 libgl1-mesa-dri"
        ) from error


def instance_row(
    matrix: NDArray[np.float64], paint: tuple[float, float, float] = (1.0, 1.0, 1.0), identity: int = 0
) -> NDArray[np.float32]:
    """(16,) one instance: its (4, 4) matrix to the world's frame, its linear paint and its id, 0 for none."""
    row = np.empty(INSTANCE_FLOATS, dtype=np.float32)
    row[:12] = matrix[:3].ravel()
    row[12:15] = paint
    row[15] = identity
    return row


Uniform = NDArray[np.floating] | tuple[float, ...] | float | int


def set_uniforms(program: Any, values: Mapping[str, Uniform]) -> None:
    """Sets those of a program's uniforms that it uses. Matrices are (4, 4) arrays, row by row."""
    for name, value in values.items():
        if name not in program:
            continue
        if isinstance(value, np.ndarray) and value.shape == (4, 4):
            program[name].write(np.ascontiguousarray(value.T, dtype=np.float32).tobytes())
        elif isinstance(value, np.ndarray):
            program[name].write(np.ascontiguousarray(value, dtype=np.float32).tobytes())
        else:
            program[name].value = value


class Drawable:
    """A mesh in the graphics card's memory."""

    def __init__(self, context: Any, mesh: Mesh) -> None:
        self._context = context
        self._vertices = context.buffer(mesh.vertices.tobytes())
        self._faces = context.buffer(np.ascontiguousarray(mesh.faces, dtype=np.int32).tobytes())
        self._capacity = 0
        self._instances: Any = None
        self._arrays: dict[int, Any] = {}

    def draw(self, program: Any, instances: NDArray[np.float32]) -> None:
        """Draws the mesh once for each row of (N, 16) ``instances``."""
        if len(instances) > self._capacity:
            self._capacity = max(8, 2 * len(instances))
            self._instances = self._context.buffer(reserve=4 * INSTANCE_FLOATS * self._capacity, dynamic=True)
            self._arrays.clear()
        self._instances.write(np.ascontiguousarray(instances, dtype=np.float32).tobytes())
        array = self._arrays.get(id(program))
        if array is None:
            array = self._arrays[id(program)] = self._array_for(program)
        array.render(instances=len(instances))

    def _array_for(self, program: Any) -> Any:
        vertex_format, vertex_names = _format_for(program, _VERTEX_INPUTS)
        instance_format, instance_names = _format_for(program, _INSTANCE_INPUTS)
        content = [
            (self._vertices, vertex_format, *vertex_names),
            (self._instances, f"{instance_format}/i", *instance_names),
        ]
        return self._context.vertex_array(program, content, self._faces)


def _format_for(program: Any, inputs: tuple[tuple[str, int], ...]) -> tuple[str, list[str]]:
    """moderngl's description of a buffer; inputs that the compiler dropped are skipped."""
    parts = [f"{size}f" if name in program else f"{4 * size}x" for name, size in inputs]
    return " ".join(parts), [name for name, _ in inputs if name in program]
