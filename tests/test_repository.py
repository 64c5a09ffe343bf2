"""Promises of the repository itself: what is tracked, what is described, and that versions agree."""

import json
import re
import subprocess
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import yaml

from app import __version__

REPOSITORY = Path(__file__).resolve().parents[1]
LARGEST_FILE_BYTES = 3_000_000


@cache
def tracked_files() -> tuple[Path, ...]:
    """What git tracks and has not been deleted; skips outside of a clone, as in a source distribution."""
    if not (REPOSITORY / ".git").exists():
        pytest.skip("needs a git clone: this tree is none")
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=REPOSITORY, capture_output=True, text=True, check=True)
    return tuple(path for name in listed.stdout.split("\0") if name and (path := REPOSITORY / name).is_file())


def text_of(path: Path) -> str | None:
    """The content of a text file; None for other files."""
    try:
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        return None


def test_no_tracked_file_is_large() -> None:
    large = {path.name: size for path in tracked_files() if (size := path.stat().st_size) > LARGEST_FILE_BYTES}
    assert large == {}


def test_no_tracked_file_names_a_place_of_one_machine() -> None:
    place = re.compile(r"(?<![\w.~$}-])/(?:home|root|work|Users)/[\w.]")
    found = [
        f"{path.relative_to(REPOSITORY)}:{number}"
        for path in tracked_files()
        for number, line in enumerate((text_of(path) or "").splitlines(), start=1)
        if place.search(line)
    ]
    assert found == []


def test_no_module_has_a_name_that_says_nothing() -> None:
    empty_names = {"util", "utils", "helper", "helpers", "common", "misc"}
    assert [path for path in tracked_files() if empty_names & {path.stem.lower(), path.parent.name.lower()}] == []


@pytest.fixture(scope="module")
def locked_packages() -> dict[str, Any]:
    """Entries of the page's lock file by their place under frontend/."""
    return json.loads((REPOSITORY / "frontend" / "package-lock.json").read_text(encoding="utf-8"))["packages"]


def test_lock_file_holds_no_download_address(locked_packages: dict[str, Any]) -> None:
    assert [name for name, package in locked_packages.items() if "://" in package.get("resolved", "")] == []


def test_lock_file_names_every_optional_package(locked_packages: dict[str, Any]) -> None:
    """`npm ci` refuses a lock file that lacks one, even one for another system.

    A registry that does not serve all systems makes `npm install` leave them out.
    """
    missing = [
        optional
        for package in locked_packages.values()
        for optional in package.get("optionalDependencies", {})
        if f"node_modules/{optional}" not in locked_packages
    ]
    assert missing == []


def test_bare_make_lists_every_target() -> None:
    phony = re.search(r"^\.PHONY: (.*)$", (REPOSITORY / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
    assert phony is not None
    listed = subprocess.run(
        ["make", "--no-print-directory"], cwd=REPOSITORY, capture_output=True, text=True, check=True
    )
    described = dict(re.findall(r"^  (\w+) +(\S.*)$", listed.stdout, re.MULTILINE))
    assert set(described) == set(phony[1].split())
    assert set(described) >= {"demo", "test", "lint", "bench", "openapi", "frontend"}


def test_versions_agree() -> None:
    newest = re.search(r"^## \[(\d[^]]*)\]", (REPOSITORY / "CHANGELOG.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert newest is not None
    assert newest[1] == __version__
    interface = json.loads((REPOSITORY / "frontend" / "openapi.json").read_text(encoding="utf-8"))
    assert interface["info"]["version"] == __version__


def test_licence_is_apache_2() -> None:
    lines = (REPOSITORY / "LICENSE").read_text(encoding="utf-8").split("\n")
    assert [line.strip() for line in lines if line.strip()][:2] == ["Apache License", "Version 2.0, January 2004"]
    assert len(lines) > 200  # the whole text


def test_containers_are_published_on_loopback_only() -> None:
    compose = yaml.safe_load((REPOSITORY / "docker-compose.yml").read_text(encoding="utf-8"))
    services = compose["services"]
    assert set(services) == {"web", "worker"}
    ports = [port for service in services.values() for port in service.get("ports", [])]
    assert ports
    assert all(str(port).startswith("127.0.0.1:") for port in ports)
    assert not any("network_mode" in service for service in services.values())
    for service in services.values():
        assert any(volume.startswith("data:/data") for volume in service["volumes"])
        assert (REPOSITORY / service["build"]["dockerfile"]).is_file()


def test_links_between_documents_lead_somewhere() -> None:
    broken = [
        f"{path.relative_to(REPOSITORY)}: {target}"
        for path in tracked_files()
        if path.suffix == ".md"
        for target in re.findall(r"(?:\]\(|src=\"|srcset=\")([^)\s#\"]+)", path.read_text(encoding="utf-8"))
        if "://" not in target and not (path.parent / target).exists()
    ]
    assert broken == []
