"""The page's build hook: when a build is due, and which node it takes."""

import importlib.util
import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def hook() -> ModuleType:
    """``frontend/hatch_build.py``, loaded by path as hatch does."""
    spec = importlib.util.spec_from_file_location("hatch_build", REPOSITORY / "frontend" / "hatch_build.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["hatch_build"] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A repository with a page's sources and a built page whose digest is written by the test."""
    for name, content in {
        "frontend/index.html": "<html>",
        "frontend/package-lock.json": "{}",
        "frontend/src/main.ts": "start()",
        "frontend/src/main.test.ts": "expect()",
        "app/static/index.html": "<html>",
    }.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(content)
    return tmp_path


@pytest.mark.parametrize(
    ("version", "fit"),
    [
        ("v20.19.0\n", True),  # the oldest one that vite 8 takes
        ("v20.18.3\n", False),  # just below it
        ("v21.7.0\n", False),  # an odd release between the two lines
        ("v22.11.0\n", False),  # just below the second line
        ("v22.12.0\n", True),
        ("v24.0.0\n", True),  # major counts before minor
        ("v18.20.8\n", False),
        ("", False),  # a node that does not start
        ("nonsense", False),
    ],
)
def test_node_is_fit_when_vite_runs_on_it(hook: ModuleType, version: str, fit: bool) -> None:
    assert hook.is_fit(version) is fit


def test_page_is_current_only_with_the_digest_of_its_sources(hook: ModuleType, tree: Path) -> None:
    page = hook.Page(tree)
    digest = tree / "app" / "static" / "sources.sha256"
    assert not page.is_current()  # built by hand: nobody knows from what
    digest.write_text(page.source_digest() + "\n")
    assert page.is_current()
    (tree / "frontend" / "src" / "main.ts").write_text("start(2)")
    assert not page.is_current()
    digest.write_text(page.source_digest() + "\n")
    (tree / "app" / "static" / "index.html").unlink()
    assert not page.is_current()


@pytest.mark.parametrize(
    ("name", "changes"),
    [
        ("src/added.ts", True),  # a new source, even in an empty file
        ("public/favicon.svg", True),
        ("vite.config.ts", True),
        ("src/main.test.ts", False),  # a test is no part of the page
        ("node_modules/react/index.js", False),  # follows from package-lock.json
        ("openapi.json", False),  # the client made from it lies in src
    ],
)
def test_digest_follows_the_sources(hook: ModuleType, tree: Path, name: str, changes: bool) -> None:
    before = hook.Page(tree).source_digest()
    path = tree / "frontend" / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("")
    assert (hook.Page(tree).source_digest() != before) is changes


def test_a_renamed_source_changes_the_digest(hook: ModuleType, tree: Path) -> None:
    before = hook.Page(tree).source_digest()
    source = tree / "frontend" / "src" / "main.ts"
    source.rename(source.with_name("start.ts"))
    assert hook.Page(tree).source_digest() != before


def test_launchers_start_npm_by_its_script(hook: ModuleType, tmp_path: Path) -> None:
    node = hook.find_node()
    assert node is not None, "pyright[nodejs] in the dev extra brings a node"
    folder = tmp_path / "with space"
    folder.mkdir()
    node.write_launchers(folder)
    environment = {**os.environ, "PATH": f"{folder}{os.pathsep}{os.environ['PATH']}"}
    done = subprocess.run(
        [folder / "npm", "--version"], env=environment, capture_output=True, text=True, check=True, cwd=tmp_path
    )
    assert done.stdout.strip().split(".")[0].isdigit()


def test_a_tree_without_a_lock_file_says_so(hook: ModuleType, tree: Path) -> None:
    (tree / "frontend" / "package-lock.json").unlink()
    with pytest.raises(hook.PageBuildError, match=r"package-lock\.json is missing"):
        hook.Page(tree).build()
