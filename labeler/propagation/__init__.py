"""Step 5: the best observation's label for all of its identity, with lineage."""

from labeler.propagation.best_observation import find_donors, label_observations
from labeler.propagation.config import PropagationConfig
from labeler.propagation.errors import PropagationError
from labeler.propagation.types import Donor, Labels, LabelSource, Withheld

__all__ = [
    "Donor",
    "LabelSource",
    "Labels",
    "PropagationConfig",
    "PropagationError",
    "Withheld",
    "find_donors",
    "label_observations",
]
