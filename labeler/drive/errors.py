"""What can be wrong with a recorded drive."""

from labeler.errors import HindsightError


class DriveError(HindsightError):
    """The drive as a whole can't be used: the message says why and what to do."""


class DriveFileError(HindsightError):
    """One file of a drive can't be used (truncated, wrong type, NaN). The caller reports it and skips the file."""
