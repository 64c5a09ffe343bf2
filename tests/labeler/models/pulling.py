"""What the tests of pulling share."""

import threading
from collections.abc import Callable
from dataclasses import dataclass, field

from labeler.models import Pulled

NAME, FILE = "yolox-nano", "yolox_nano.onnx"

Pulling = Callable[..., Pulled]


@dataclass
class Heard:
    """What a pull tells of its progress; ``on_advance`` is called with the bytes so far."""

    begun: list[tuple[int, int | None]] = field(default_factory=list[tuple[int, int | None]])
    came: int = 0
    waited: threading.Event = field(default_factory=threading.Event)
    on_advance: Callable[[int], None] = lambda came: None

    def waiting(self) -> None:
        self.waited.set()

    def begin(self, *, done_bytes: int, total_bytes: int | None) -> None:
        self.begun.append((done_bytes, total_bytes))

    def advance(self, count_bytes: int) -> None:
        self.came += count_bytes
        self.on_advance(self.came)
