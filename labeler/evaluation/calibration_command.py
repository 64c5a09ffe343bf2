"""What the commands that fit a model of curves have in common: where their samples come from, and where it goes.

Samples are of drives with truth, as each of some detectors sees them, and of text sequences with detections and truth
(:mod:`labeler.evaluation.text_sequences`). Some are fitted on, others checked.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from labeler.tracking.curves import CurveModel

Sample = TypeVar("Sample")


@dataclass(frozen=True)
class CalibrationOptions:
    """What a person asked for. Without ``out`` nothing is fitted: the model that ships is checked."""

    models: tuple[Path, ...]
    workspace: Path
    fit: tuple[Path, ...]
    check: tuple[Path, ...]
    text: Path | None
    text_fit: tuple[str, ...]
    text_check: tuple[str, ...]
    out: Path | None

    def of_text(
        self, names: Sequence[str], samples_of: Callable[[Path, Sequence[str]], Iterable[Sample]]
    ) -> list[Sample]:
        """The samples of text sequences of these names."""
        return [] if self.text is None else list(samples_of(self.text, names))

    def write(self, model: CurveModel) -> None:
        """Write a model where it was asked for."""
        if self.out is not None:
            self.out.write_text(json.dumps(model.to_json(), indent=1) + "\n", encoding="utf-8")


def parse_options(description: str | None) -> CalibrationOptions:
    """The options on the command line."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--model", type=Path, nargs="*", default=[], help="YOLOX files (.onnx) that look at drives")
    parser.add_argument("--workspace", type=Path, required=True, help="folder that keeps what is done of the drives")
    parser.add_argument("--fit", type=Path, nargs="*", default=[], help="drives with true boxes to fit on")
    parser.add_argument("--check", type=Path, nargs="*", default=[], help="other drives, for the tables")
    parser.add_argument("--text", type=Path, help="folder of text sequences")
    parser.add_argument("--text-fit", nargs="*", default=[], help="sequences of it to fit on")
    parser.add_argument("--text-check", nargs="*", default=[], help="other sequences, for the tables")
    parser.add_argument("--out", type=Path, help="the model to write; without it, the one that ships is checked")
    given = parser.parse_args()
    if (given.fit or given.check) and not given.model:
        parser.error("drives (--fit, --check) need a --model that looks at them")
    if (given.text_fit or given.text_check) and given.text is None:
        parser.error("sequences (--text-fit, --text-check) need the folder that they lie in (--text)")
    return CalibrationOptions(
        models=tuple(given.model),
        workspace=given.workspace,
        fit=tuple(given.fit),
        check=tuple(given.check),
        text=given.text,
        text_fit=tuple(given.text_fit),
        text_check=tuple(given.text_check),
        out=given.out,
    )
