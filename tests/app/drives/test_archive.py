"""Unpacking archives: good ones arrive whole, bad ones are refused."""

import io
import os
import tarfile
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Literal

import pytest

from app.drives.archive import UnpackLimits, unpack
from app.errors import BadArchive, DiskFull

LIMITS = UnpackLimits(max_files=10, max_bytes=1_000_000, max_ratio=100.0, min_free_bytes=0)
CONTENT = {"drive/a.txt": b"a" * 10, "drive/deep/b.bin": bytes(range(256))}


def _zip(path: Path, members: dict[str, bytes], *, mode: int = 0o100644) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            info = zipfile.ZipInfo(name)
            info.external_attr = mode << 16
            archive.writestr(info, content, zipfile.ZIP_DEFLATED)
    return path


def _tar(path: Path, members: dict[str, bytes], mode: Literal["w", "w:gz", "w:bz2", "w:xz"] = "w") -> Path:
    with tarfile.open(path, mode) as archive:
        for name, content in members.items():
            info = tarfile.TarInfo(name)
            info.size = len(content)
            archive.addfile(info, io.BytesIO(content))
    return path


def _tar_of(path: Path, kind: bytes, linkname: str = "") -> Path:
    with tarfile.open(path, "w") as archive:
        info = tarfile.TarInfo("drive/odd")
        info.type, info.linkname = kind, linkname
        archive.addfile(info)
    return path


def _files(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize(
    "pack",
    [
        lambda path: _zip(path, CONTENT),
        lambda path: _tar(path, CONTENT),
        lambda path: _tar(path, CONTENT, "w:gz"),
        lambda path: _tar(path, CONTENT, "w:bz2"),
        lambda path: _tar(path, CONTENT, "w:xz"),
    ],
    ids=["zip", "tar", "gz", "bz2", "xz"],
)
def test_content_arrives_whole(tmp_path: Path, pack: Callable[[Path], Path]) -> None:
    unpack(pack(tmp_path / "archive"), tmp_path / "target", limits=LIMITS)
    assert _files(tmp_path / "target") == CONTENT


BAD_NAMES = [
    "/etc/passwd",  # from the root
    "../out.txt",  # beside the target
    "drive/../../out.txt",  # by a detour
    "drive\\..\\out.txt",  # as Windows writes it
    "C:out.txt",  # a drive letter
    "drive/a\nb.txt",  # a control character
    "drive/" + "x" * 300,  # longer than a file's name may be
    "x/" * 40 + "deep.txt",  # deeper than any drive
]


@pytest.mark.parametrize("name", BAD_NAMES)
@pytest.mark.parametrize("pack", [_zip, _tar], ids=["zip", "tar"])
def test_names_that_are_refused(tmp_path: Path, name: str, pack: Callable[[Path, dict[str, bytes]], Path]) -> None:
    archive = pack(tmp_path / "archive", {name: b"x"})
    with pytest.raises(BadArchive, match="inside it"):
        unpack(archive, tmp_path / "inside" / "target", limits=LIMITS)
    assert _files(tmp_path) == {"archive": archive.read_bytes()}


@pytest.mark.parametrize(
    "pack",
    [
        lambda path: _tar_of(path, tarfile.SYMTYPE, "/etc"),
        lambda path: _tar_of(path, tarfile.LNKTYPE, "../secret"),
        lambda path: _tar_of(path, tarfile.CHRTYPE),
        lambda path: _tar_of(path, tarfile.FIFOTYPE),
        lambda path: _zip(path, {"drive/link": b"/etc"}, mode=0o120777),
    ],
    ids=["symlink", "hard link", "device", "fifo", "symlink in zip"],
)
def test_links_and_devices_are_refused(tmp_path: Path, pack: Callable[[Path], Path]) -> None:
    with pytest.raises(BadArchive, match="link or a device"):
        unpack(pack(tmp_path / "archive"), tmp_path / "target", limits=LIMITS)
    assert _files(tmp_path / "target") == {}


@pytest.mark.parametrize(
    "members",
    [
        {"drive/a.txt": b"1", "drive/A.TXT": b"2"},  # one file on some disks
        {"drive/a/b.txt": b"1", "Drive/c.txt": b"2"},  # one folder on some disks
        {"drive": b"1", "drive/a.txt": b"2"},  # a file where a folder must be
        {"drive/a.txt": b"1", "drive/./a.txt": b"2"},  # the same twice
        {"drive/\u00e9": b"1", "drive/e\u0301": b"2"},  # an accent, in one letter or two
    ],
)
@pytest.mark.parametrize("pack", [_zip, _tar], ids=["zip", "tar"])
def test_members_at_one_place_are_refused(
    tmp_path: Path, members: dict[str, bytes], pack: Callable[[Path, dict[str, bytes]], Path]
) -> None:
    with pytest.raises(BadArchive, match="in the archive"):
        unpack(pack(tmp_path / "archive", members), tmp_path / "target", limits=LIMITS)


def test_sizes_in_headers_are_not_believed(tmp_path: Path) -> None:
    archive = _zip(tmp_path / "archive", {"big": b"\0" * 500_000})
    content = bytearray(archive.read_bytes())
    for signature, offset in ((b"PK\x03\x04", 22), (b"PK\x01\x02", 24)):
        at = content.index(signature) + offset
        content[at : at + 4] = (100).to_bytes(4, "little")  # it says 100 bytes
    archive.write_bytes(content)
    limits = UnpackLimits(max_files=10, max_bytes=1_000, max_ratio=100.0, min_free_bytes=0)
    with pytest.raises(BadArchive):
        unpack(archive, tmp_path / "target", limits=limits)
    assert sum(len(file) for file in _files(tmp_path / "target").values()) <= 1_000


@pytest.mark.parametrize("pack", [_zip, lambda path, members: _tar(path, members, "w:gz")], ids=["zip", "gz"])
def test_what_unpacks_to_too_much_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, pack: Callable[[Path, dict[str, bytes]], Path]
) -> None:
    archive = pack(tmp_path / "archive", {"zeros": b"\0" * 900_000})  # about a thousandth packed
    unpack(archive, tmp_path / "allowed", limits=LIMITS)  # small enough to be free
    monkeypatch.setattr("app.drives.archive.FREE_UNPACK_BYTES", 100_000)
    with pytest.raises(BadArchive, match="unpacks to more"):
        unpack(archive, tmp_path / "target", limits=LIMITS)


def test_too_many_files_are_refused(tmp_path: Path) -> None:
    archive = _tar(tmp_path / "archive", {str(number): b"" for number in range(11)})
    with pytest.raises(BadArchive, match="more than 10 files"):
        unpack(archive, tmp_path / "target", limits=LIMITS)


def test_a_huge_header_is_refused(tmp_path: Path) -> None:
    info = tarfile.TarInfo("header")
    info.type, info.size = tarfile.XHDTYPE, 10**12  # a pax header of a terabyte, as it says
    (tmp_path / "archive").write_bytes(info.tobuf(tarfile.GNU_FORMAT) + b"\0" * 1024)
    with pytest.raises(BadArchive, match="header"):
        unpack(tmp_path / "archive", tmp_path / "target", limits=LIMITS)


@pytest.mark.parametrize(
    "content",
    [
        b"no archive at all, but long enough to be one" * 30,
        b"PK\x03\x04 but no zip",
        b"\x1f\x8b but no gzip",
        b"BZh9 but no bzip2",
        b"\xfd7zXZ\x00 but no xz",
    ],
)
def test_what_is_no_archive_is_refused(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "archive").write_bytes(content)
    with pytest.raises(BadArchive):
        unpack(tmp_path / "archive", tmp_path / "target", limits=LIMITS)


def test_a_cut_off_archive_is_refused(tmp_path: Path) -> None:
    for pack in (_zip, lambda path, members: _tar(path, members, "w:gz")):
        archive = pack(tmp_path / "archive", {"noise": os.urandom(50_000)})
        archive.write_bytes(archive.read_bytes()[:30_000])
        with pytest.raises(BadArchive):
            unpack(archive, tmp_path / f"target of {pack}", limits=LIMITS)


def test_an_empty_archive_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BadArchive, match="no files"):
        unpack(_zip(tmp_path / "archive", {}), tmp_path / "target", limits=LIMITS)


def test_an_encrypted_zip_is_refused(tmp_path: Path) -> None:
    archive = _zip(tmp_path / "archive", {"a": b"x"})
    content = bytearray(archive.read_bytes())
    for signature, offset in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        content[content.index(signature) + offset] |= 1
    archive.write_bytes(content)
    with pytest.raises(BadArchive, match="without a password"):
        unpack(archive, tmp_path / "target", limits=LIMITS)


def test_a_zip_with_an_unknown_compression_is_not_called_damaged(tmp_path: Path) -> None:
    archive = _zip(tmp_path / "archive", {"a": b"x"})
    content = bytearray(archive.read_bytes())
    ppmd = 98
    for signature, offset in ((b"PK\x03\x04", 8), (b"PK\x01\x02", 10)):
        content[content.index(signature) + offset] = ppmd
    archive.write_bytes(content)
    with pytest.raises(BadArchive, match=r"compression method is not supported.*ordinary zip"):
        unpack(archive, tmp_path / "target", limits=LIMITS)


def test_a_full_disk_is_told(tmp_path: Path) -> None:
    limits = UnpackLimits(max_files=10, max_bytes=10**9, max_ratio=100.0, min_free_bytes=10**18)
    with pytest.raises(DiskFull):
        unpack(_zip(tmp_path / "archive", CONTENT), tmp_path / "target", limits=limits)


def test_no_rights_are_taken_over(tmp_path: Path) -> None:
    unpack(_zip(tmp_path / "archive", {"run.sh": b"#!"}, mode=0o104777), tmp_path / "target", limits=LIMITS)
    assert (tmp_path / "target" / "run.sh").stat().st_mode & 0o7111 == 0
