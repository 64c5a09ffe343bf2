"""What can go wrong with the registry, the cache and a download. Every message says what to do."""

from labeler.errors import HindsightError


class ModelStoreError(HindsightError):
    """A name that no model has, a file that can't be added, or a cache folder that can't be used."""


class PullError(ModelStoreError):
    """A download that failed: see the subclasses for what it may be."""


class ProxyProblem(PullError):
    """A proxy refuses, wants a login, or opens encrypted traffic by a certificate that is not trusted here."""


class SourceProblem(PullError):
    """The source can't be reached, has no such file, or answers something else."""


class BrokenOff(PullError):
    """The connection ended before the file did; what came is kept, and the next pull goes on from there."""


class DiskFull(PullError):
    """The file does not fit; what came is kept."""


class WrongBytes(PullError):
    """What came is not the model that was published; it is not kept."""
