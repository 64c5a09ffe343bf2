"""What can be wrong with the input of a tracker."""

from labeler.errors import HindsightError


class TrackingError(HindsightError):
    """Detections can't be tracked as they came, or the settings make no sense: the message says why and what to do."""
