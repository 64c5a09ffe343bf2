"""The method of merging that the settings name."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from labeler.identity.algorithm_2 import merge_at_same_place
from labeler.identity.config import BASELINE, IdentityConfig
from labeler.identity.constraints import Decisions
from labeler.identity.merging import merge_by_assignment
from labeler.identity.rig import Rig
from labeler.identity.types import Merges, MultiCameraFrame


def find_merges(
    frames: Iterable[MultiCameraFrame],
    config: IdentityConfig,
    *,
    class_groups: Sequence[int],
    rig: Rig,
    colours: Mapping[int, NDArray[np.float32]] | None = None,
    decisions: Decisions | None = None,
) -> Merges:
    """Which tracks are one object, and which a person should look at.

    ``frames`` are read once, in order of time, and not kept; ``rig`` tells where cameras and car were,
    ``colours`` the histogram of each track (:mod:`labeler.identity.colours`), as far as it is known. Only tracks of one
    number in ``class_groups[class_id]`` are merged. ``decisions`` of a person hold in any case, but for the
    baseline, which is the paper's method as it stands. Raises ValueError for a class without a number.
    """
    if config.method == BASELINE:
        return merge_at_same_place(frames, config.algorithm_2, class_groups=class_groups)
    return merge_by_assignment(frames, config, class_groups=class_groups, rig=rig, colours=colours, decisions=decisions)
