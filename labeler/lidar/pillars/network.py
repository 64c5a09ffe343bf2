"""A pillar network in an ONNX file.

The file takes ``points`` (P, M, F) float32 and ``cells`` (P,) int64, as :class:`labeler.lidar.pillars.grouping.Pillars`
has them, and puts out (1, C, rows / 2, columns / 2), as :class:`labeler.lidar.pillars.decode.Outputs` reads it. Its
metadata say, as JSON: ``classes``, ``painted`` (the scores that a point must carry, or none), and ``grid``.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from pydantic import TypeAdapter, ValidationError

from labeler.inference import CPU_PROVIDER, ModelError
from labeler.inference.sessions import open_session
from labeler.lidar.pillars.decode import STRIDE, Outputs, PillarBoxes, decode
from labeler.lidar.pillars.direction import PAINTED_CLASSES, columns_for
from labeler.lidar.pillars.grouping import POINTS_PER_PILLAR, Grid, features_of, pillars_of

_NAMES = TypeAdapter(tuple[str, ...])
_GRID = TypeAdapter(Grid)


class PillarModel:
    """An opened pillar network. ``class_names`` are its classes, ``painted`` is whether it takes painted points."""

    def __init__(self, path: Path, *, threads: int = 1) -> None:
        """ModelError when the file is no pillar network, or one of another form."""
        session = open_session(path, providers=(CPU_PROVIDER,), intra_op_threads=threads)
        said = session.metadata
        if said.get("task") != "pillars":
            raise ModelError(f"{path} does not say that it is a pillar network. Train one: hindsight train pillars")
        try:
            self.class_names = _NAMES.validate_json(said["classes"])
            painted = _NAMES.validate_json(said["painted"])
            self.grid = _GRID.validate_json(said["grid"])
        except (KeyError, ValidationError) as error:
            raise ModelError(
                f"{path} says too little about itself, or what can't be: {error}. Train it again."
            ) from error
        if painted not in ((), PAINTED_CLASSES):
            raise ModelError(f"{path} takes points painted with {', '.join(painted)}; known are {PAINTED_CLASSES}.")
        self.painted = bool(painted)
        self._columns = columns_for(painted)
        self._session = session
        shapes = {item.name: tuple(item.shape)[1:] for item in session.inputs}
        wanted = {"points": (POINTS_PER_PILLAR, features_of(self._columns)), "cells": ()}
        channels = Outputs.channels(len(self.class_names))
        output = (1, channels, self.grid.rows // STRIDE, self.grid.columns // STRIDE)
        if shapes != wanted or tuple(session.outputs[0].shape) != output:
            raise ModelError(
                f"{path} takes {shapes} and gives {tuple(session.outputs[0].shape)}, but a pillar network of this "
                f"version takes {wanted} and gives {output}. Train it again."
            )

    def find(self, cloud: NDArray[np.float32], *, min_score: float) -> PillarBoxes:
        """The boxes in an (N, D) cloud of a direction, see :func:`labeler.lidar.pillars.direction.direction_cloud`."""
        pillars = pillars_of(np.ascontiguousarray(cloud[:, : self._columns]), self.grid)
        output = self._session.run({"points": pillars.points, "cells": pillars.cell})[0]
        return decode(output[0], self.grid, min_score=min_score)
