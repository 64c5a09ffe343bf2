"""Step 5: the best observation's label for all of its identity, with lineage."""

from labeler.propagation.config import PropagationConfig, usual_min_trust
from labeler.propagation.errors import PropagationError
from labeler.propagation.labelling import label_observations
from labeler.propagation.types import Donor, Labels, LabelSource, Votes, Withheld
from labeler.propagation.votes import collect_votes, donor_of

__all__ = [
    "Donor",
    "LabelSource",
    "Labels",
    "PropagationConfig",
    "PropagationError",
    "Votes",
    "Withheld",
    "collect_votes",
    "donor_of",
    "label_observations",
    "usual_min_trust",
]
