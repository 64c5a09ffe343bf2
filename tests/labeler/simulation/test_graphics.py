"""What one is told when there is nothing to render with."""

import subprocess
import sys

import numpy as np
import pytest

from labeler.simulation.errors import SimulationError
from labeler.simulation.graphics import instance_row, open_context


def test_without_moderngl_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "moderngl", None)  # as if it were not installed

    with pytest.raises(SimulationError, match=r"pip install 'hindsight-labeler\[simulation\]'"):
        open_context()


def test_without_opengl_the_packages_are_named() -> None:
    pytest.importorskip("moderngl", reason="needs moderngl, of the extra `simulation`")
    code = (
        "from labeler.simulation.errors import SimulationError\n"
        "from labeler.simulation.graphics import open_context\n"
        "try:\n    open_context()\n"
        "except SimulationError as error:\n    print(error)\n"
    )
    environment = {"__EGL_VENDOR_LIBRARY_FILENAMES": "/nowhere.json", "PYTHONPATH": ":".join(sys.path)}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)

    assert "apt-get install libegl1 libgl1 libgl1-mesa-dri" in done.stdout


def test_an_instance_is_three_rows_a_paint_and_an_id() -> None:
    matrix = np.arange(16, dtype=np.float64).reshape(4, 4)

    assert instance_row(matrix, (0.25, 0.5, 0.75), 9).tolist() == [*range(12), 0.25, 0.5, 0.75, 9]
