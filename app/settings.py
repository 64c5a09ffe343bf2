"""What a person can set: environment variables that begin with HINDSIGHT_, or options of ``hindsight serve``.

Every field says in its description what it does; ``docs/settings.md`` lists them all, and a test keeps it so.
"""

import ipaddress
import os
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError, field_validator
from pydantic_settings import BaseSettings, NoDecode, SettingsConfigDict

from labeler.errors import HindsightError
from labeler.models import ModelCache
from labeler.propagation import PropagationConfig, usual_min_trust

PREFIX = "HINDSIGHT_"
GIB = 1024**3


def default_workspace() -> Path:
    """``hindsight`` in the user's data folder (XDG_DATA_HOME, else ~/.local/share)."""
    data_home = os.environ.get("XDG_DATA_HOME")
    return (Path(data_home) if data_home else Path.home() / ".local" / "share") / "hindsight"


def default_models() -> Path:
    """``hindsight/models`` in the user's cache folder (XDG_CACHE_HOME, else ~/.cache)."""
    cache_home = os.environ.get("XDG_CACHE_HOME")
    return (Path(cache_home) if cache_home else Path.home() / ".cache") / "hindsight" / "models"


class Settings(BaseSettings):
    """Settings of the web server and of the worker. Both must be given the same ones."""

    model_config = SettingsConfigDict(env_prefix=PREFIX, env_ignore_empty=True, frozen=True, protected_namespaces=())

    workspace: Path = Field(
        default_factory=default_workspace,
        description="Folder that holds the store, uploaded drives, artifacts of labelling and exports.",
    )
    database_url: str | None = Field(
        default=None, description="SQLAlchemy URL of the store; without it, SQLite in the workspace is used."
    )
    host: str = Field(default="127.0.0.1", description="Address that the web server listens on.")
    port: int = Field(default=8000, ge=0, le=65535, description="Port of the web server; 0 takes any free one.")
    model: str | None = Field(
        default=None,
        description="Model that drives are labelled with when none is named: a YOLOX file (.onnx), or a name of "
        "`hindsight models list`. Without it: the best official one in the cache, else the one that ships.",
    )
    segmentation: str | None = Field(
        default=None,
        description="Model that images are segmented with to paint LiDAR points: a file (.onnx), a name, or `none`. "
        "Without it: the one that ships, on simulated drives.",
    )
    boxes: str | None = Field(
        default=None,
        description="What makes 3D boxes of LiDAR points: a pillar network, by file (.onnx) or name, or `clusters`, "
        "which needs no weights. Without it: the network that ships, where a simulated drive is segmented, else "
        "`clusters`.",
    )
    models: Path = Field(default_factory=default_models, description="Folder that pulled and added models lie in.")
    model_mirror: str | None = Field(
        default=None,
        description="Address of a folder that holds the official model files; `hindsight models pull` takes them from "
        "there.",
    )
    identity: Literal["assignment", "baseline"] = Field(
        default="assignment",
        description="How tracks are merged: all evidence at once, or the paper's Algorithm 2 as it stands (baseline).",
    )
    propagation: Literal["highest", "top-k"] = Field(
        default="highest",
        description="Whose label all sightings of an object get: the surest one's, as in the paper, or that of the "
        "class that wins a vote of the surest (top-k).",
    )
    top_k: int = Field(default=5, ge=1, description="How many sightings vote on the class with top-k.")
    donor_window_s: float = Field(
        default=0.0,
        ge=0,
        description="A label comes from a sighting less than this many seconds away; 0 takes it from any time.",
    )
    min_trust: float | None = Field(
        default=None,
        ge=0,
        le=1,
        description="A sighting whose box shows the tracked object with less probability than this keeps the "
        "detector's own label; 0 keeps none back, as in the paper. Without it: 0.25 for a small detector (a file below "
        "8 MB, as YOLOX-nano's), which would find little else, and 0.45 for others.",
    )
    allowed_hosts: Annotated[tuple[str, ...], NoDecode] = Field(
        default=(),
        description="Host names, separated by commas, that the server answers to beside localhost and its address.",
    )
    allow_local_paths: bool = Field(
        default=False,
        description="Let the page register folders and models of the server's disk even when others can reach it.",
    )
    reviewer: str = Field(default="local", min_length=1, description="Name that is kept with every decision made here.")
    max_upload_bytes: int = Field(default=64 * GIB, gt=0, description="Largest archive that may be uploaded, in bytes.")
    max_unpacked_bytes: int = Field(
        default=128 * GIB, gt=0, description="How much an uploaded archive may unpack to, in bytes."
    )
    max_unpack_ratio: float = Field(
        default=100.0,
        gt=1,
        description="How many times its own size an archive may unpack to (small ones, to 64 MiB, are free).",
    )
    max_files: int = Field(default=1_000_000, gt=0, description="How many files an uploaded archive may hold.")
    min_free_bytes: int = Field(
        default=1 * GIB, ge=0, description="Disk space that an upload must leave free, in bytes."
    )
    stale_job_seconds: float = Field(
        default=30.0, gt=0, description="A running job without a sign of life for this long is given to another worker."
    )
    max_job_attempts: int = Field(
        default=3, ge=1, description="A job whose worker died this often is given up as failed."
    )
    job_poll_seconds: float = Field(
        default=0.3, gt=0, description="How often the worker looks for jobs and the page's progress is renewed."
    )

    @field_validator("allowed_hosts", mode="before")
    @classmethod
    def _split_at_commas(cls, value: object) -> object:
        return tuple(name.strip() for name in value.split(",") if name.strip()) if isinstance(value, str) else value

    def as_environment(self) -> dict[str, str]:
        """Environment variables that give another process these settings."""
        return {
            f"{PREFIX}{name.upper()}": ",".join(value) if isinstance(value, tuple) else str(value)
            for name, value in self
            if value is not None
        }

    def propagation_config(self, detector: Path) -> PropagationConfig:
        """How the labels of a detector, a model file, are given."""
        min_trust = usual_min_trust(detector) if self.min_trust is None else self.min_trust
        return PropagationConfig(
            rule=self.propagation, top_k=self.top_k, window_s=self.donor_window_s, min_trust=min_trust
        )

    @property
    def store_url(self) -> str:
        """The URL of the store that is in use."""
        return self.database_url or f"sqlite:///{self.workspace / 'hindsight.db'}"

    @property
    def model_cache(self) -> ModelCache:
        """The models that were pulled or added."""
        return ModelCache(self.models)

    @property
    def drives_folder(self) -> Path:
        """Where uploaded drives lie, a folder each."""
        return self.workspace / "drives"

    @property
    def uploads_folder(self) -> Path:
        """Where uploads lie until they are whole."""
        return self.workspace / "uploads"

    @property
    def exports_folder(self) -> Path:
        """Where exported datasets lie."""
        return self.workspace / "exports"

    @property
    def is_loopback(self) -> bool:
        """Whether only this machine can reach the server."""
        if self.host == "localhost":
            return True
        try:
            return ipaddress.ip_address(self.host).is_loopback
        except ValueError:
            return False

    @property
    def may_use_local_paths(self) -> bool:
        """Whether a path on the server's disk may come from the page."""
        return self.is_loopback or self.allow_local_paths


def load_settings(**options: Any) -> Settings:
    """Settings from the environment, over which ``options`` that are not None win.

    HindsightError where a value can't be used."""
    try:
        return Settings(**{name: value for name, value in options.items() if value is not None})
    except ValidationError as error:
        faults = "; ".join(f"{PREFIX}{str(fault['loc'][0]).upper()}: {fault['msg']}" for fault in error.errors())
        raise HindsightError(f"A setting can't be used: {faults}. See docs/settings.md.") from error
