"""``python -m tests.big_drive WORKSPACE``: make the big drive, and say how long it took."""

import sys
import time
from pathlib import Path

from tests.big_drive.making import make_workspace

if __name__ == "__main__":
    begun = time.perf_counter()
    make_workspace(Path(sys.argv[1]))
    sys.stdout.write(f"made in {time.perf_counter() - begun:.0f} s; hindsight serve --workspace {sys.argv[1]}\n")
