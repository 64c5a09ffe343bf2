"""onnxruntime's builds report to their maker unless they are told not to before they are loaded."""

import os
import subprocess
import sys
from pathlib import Path

LOOK = """
import os
from labeler.inference import CPU_PROVIDER, ModelError, open_session
from pathlib import Path
seen = []
class Watch:
    def find_spec(self, name, path=None, target=None):
        if name == "onnxruntime":
            seen.append(os.environ.get("ORT_DISABLE_TELEMETRY"))
import sys
sys.meta_path.insert(0, Watch())
Path("broken.onnx").write_bytes(b"x")
try:
    open_session(Path("broken.onnx"), providers=(CPU_PROVIDER,), intra_op_threads=1)
except ModelError:
    print(seen)
"""


def test_onnxruntime_is_told_to_report_nothing_before_it_is_loaded(tmp_path: Path) -> None:
    environment = {name: value for name, value in os.environ.items() if name != "ORT_DISABLE_TELEMETRY"}
    environment["PYTHONPATH"] = str(Path(__file__).parents[3])
    found = subprocess.run(
        [sys.executable, "-c", LOOK], cwd=tmp_path, env=environment, capture_output=True, text=True, check=True
    )
    assert found.stdout.strip() == "['1']"
