"""Settings: where they come from, and what follows from them."""

from pathlib import Path

import pytest

from app.settings import Settings, default_workspace, load_settings
from labeler.errors import HindsightError
from labeler.propagation import PropagationConfig


def test_the_workspace_is_in_the_users_data_folder(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", "/somewhere")
    assert default_workspace() == Path("/somewhere/hindsight")
    monkeypatch.delenv("XDG_DATA_HOME")
    monkeypatch.setenv("HOME", "/people/anna")
    assert default_workspace() == Path("/people/anna/.local/share/hindsight")


def test_options_win_over_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HINDSIGHT_PORT", "9000")
    monkeypatch.setenv("HINDSIGHT_HOST", "localhost")
    settings = load_settings(port=9001, host=None)
    assert (settings.port, settings.host) == (9001, "localhost")


def test_how_labels_are_given_follows_from_settings_and_detector(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    small, large = tmp_path / "nano.onnx", tmp_path / "large.onnx"
    small.write_bytes(bytes(3_700_000))
    large.write_bytes(bytes(9_000_000))
    assert load_settings().propagation_config(large) == PropagationConfig()
    assert load_settings().propagation_config(small) == PropagationConfig(min_trust=0.25)
    monkeypatch.setenv("HINDSIGHT_MIN_TRUST", "0.35")
    monkeypatch.setenv("HINDSIGHT_TOP_K", "3")
    expected = PropagationConfig(rule="top-k", top_k=3, window_s=2.0, min_trust=0.35)
    assert load_settings(propagation="top-k", donor_window_s=2.0).propagation_config(small) == expected
    assert load_settings(min_trust=0.0).propagation_config(large).min_trust == 0


def test_another_process_gets_the_same_settings(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    given = Settings(workspace=tmp_path / "w", allowed_hosts=("a.example", "b.example:81"), allow_local_paths=True)
    for name, value in given.as_environment().items():
        monkeypatch.setenv(name, value)
    assert Settings() == given


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("PORT", "70000"),
        ("MIN_TRUST", "1.1"),
        ("MAX_FILES", "0"),
        ("MAX_UPLOAD_BYTES", "many"),
        ("JOB_POLL_SECONDS", "0"),
    ],
)
def test_a_wrong_value_is_named(monkeypatch: pytest.MonkeyPatch, name: str, value: str) -> None:
    monkeypatch.setenv(f"HINDSIGHT_{name}", value)
    with pytest.raises(HindsightError, match=f"HINDSIGHT_{name}: "):
        load_settings()


@pytest.mark.parametrize(
    ("host", "is_loopback"),
    [
        ("127.0.0.1", True),
        ("127.8.8.8", True),
        ("::1", True),
        ("localhost", True),
        ("0.0.0.0", False),
        ("192.168.1.5", False),
        ("a.example", False),  # who knows where that leads
    ],
)
def test_which_addresses_only_this_machine_reaches(host: str, is_loopback: bool) -> None:
    assert Settings(host=host).is_loopback is is_loopback
    assert Settings(host=host).may_use_local_paths is is_loopback
    assert Settings(host=host, allow_local_paths=True).may_use_local_paths
