"""Which models label a drive, by the settings: one answer for the commands, the worker and the page."""

from pathlib import Path

from app.settings import Settings
from labeler.drive import is_simulated
from labeler.models import Choice, Origin, Task, available, choose_boxes, choose_detector, choose_segmentation


def chosen_detector(settings: Settings) -> Choice:
    """The detector that drives are labelled with when none is named.

    ModelStoreError where the setting names one that is not there."""
    return choose_detector(settings.model, settings.model_cache)


def offered_detectors(settings: Settings) -> list[Choice]:
    """The detectors that a person may choose from: the one that the settings name, then all on this machine."""
    on_this_machine = available(Task.DETECTION, settings.model_cache)
    chosen = chosen_detector(settings)
    return [chosen, *on_this_machine] if chosen.origin is Origin.FILE else on_this_machine


def segmentation_file(settings: Settings, drive: Path) -> Path | None:
    """The segmentation for the drive in that folder, None for none.

    ModelStoreError where the setting names one that is not there."""
    chosen = choose_segmentation(settings.segmentation, settings.model_cache, simulated=is_simulated(drive))
    return chosen.path if chosen else None


def boxes_file(settings: Settings, drive: Path) -> Path | None:
    """The pillar network that makes 3D boxes of the drive in that folder, None for those that need no weights. Where
    nothing paints points, only one that is named.

    ModelStoreError where the setting names one that is not there."""
    is_painted = segmentation_file(settings, drive) is not None
    chosen = choose_boxes(settings.boxes, settings.model_cache, simulated=is_painted and is_simulated(drive))
    return chosen.path if chosen else None
