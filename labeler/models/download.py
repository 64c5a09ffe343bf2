"""One file over HTTP, resumed where it broke off.

The standard library does the talking: it obeys HTTPS_PROXY, HTTP_PROXY and NO_PROXY, and trusts what the system trusts
(or SSL_CERT_FILE). What came so far lies in a part file, with a note beside it of the address, the server's mark of the
version (ETag) and the whole size. A part is continued only if the server says that it goes on from exactly there, in a
file of the same size; else the file begins anew.
"""

from __future__ import annotations

import errno
import http.client
import json
import re
import shutil
import socket
import ssl
import urllib.error
import urllib.request
from collections.abc import Callable
from dataclasses import asdict, dataclass
from http import HTTPStatus
from pathlib import Path
from typing import IO, Protocol
from urllib.parse import urlsplit

from labeler.models.errors import BrokenOff, DiskFull, ProxyProblem, PullError, SourceProblem, WrongBytes

TIMEOUT_S = 30.0
_CHUNK_BYTES = 1 << 18
_CONTENT_RANGE = re.compile(r"bytes (\d+)-\d+/(\d+)")
_ELSE = "Or take the file elsewhere and name it: hindsight models add FILE --as NAME."


class PullProgress(Protocol):
    """Hears how a download goes."""

    def waiting(self) -> None:
        """Another process is pulling the same model."""
        ...

    def begin(self, *, done_bytes: int, total_bytes: int | None) -> None:
        """Bytes begin to come; ``done_bytes`` are there from an earlier pull."""
        ...

    def advance(self, count_bytes: int) -> None:
        """So many more bytes have come."""
        ...


@dataclass(frozen=True)
class _PartNote:
    """What a part file is a part of."""

    url: str
    etag: str | None
    total_bytes: int | None


def open_part(path: Path, mode: str) -> IO[bytes]:
    """How a part file is opened for writing; tests give another way to see a disk fill up."""
    return path.open(mode)


def download(
    url: str,
    part: Path,
    *,
    expected_bytes: int | None,
    progress: PullProgress,
    opening: Callable[[Path, str], IO[bytes]] = open_part,
) -> None:
    """Bring the file at ``url`` into ``part``, from where an earlier call left off.

    Raises a PullError that says what to do. The part stays unless it is wrong."""
    note = _read_note(part)
    done = part.stat().st_size if note is not None and note.url == url and part.exists() else 0
    if expected_bytes is not None and done > expected_bytes:
        done = 0
    if done and expected_bytes == done:
        progress.begin(done_bytes=done, total_bytes=done)
        return
    response = _request(url, from_byte=done, etag=note.etag if note else None)
    start, total = _range_of(url, response)
    if start != done or (note is not None and start and total != note.total_bytes):
        if start:  # another part than the one asked for, or one of another file
            response.close()
            response = _request(url, from_byte=0, etag=None)
            start, total = _range_of(url, response)
        done = 0
    with response:
        if start != done:
            raise SourceProblem(f"{_host(url)} does not send the beginning of the file. {_ELSE}")
        _check_answer(url, response, total, expected_bytes)
        _check_space(part, (total or 0) - done)
        _write_note(part, _PartNote(url, response.headers.get("ETag"), total))
        progress.begin(done_bytes=done, total_bytes=total)
        done = _receive(url, response, part, done=done, total=total, progress=progress, opening=opening)
    whole = total if total is not None else expected_bytes
    if whole is not None and done < whole:
        raise _broken(url, done, whole, "the other side ended it")


def forget_part(part: Path) -> None:
    """Delete a part file and its note."""
    part.unlink(missing_ok=True)
    _note_path(part).unlink(missing_ok=True)


def _receive(
    url: str,
    response: http.client.HTTPResponse,
    part: Path,
    *,
    done: int,
    total: int | None,
    progress: PullProgress,
    opening: Callable[[Path, str], IO[bytes]],
) -> int:
    """Append what comes to the part; how many bytes it then has."""
    try:
        with opening(part, "ab" if done else "wb") as file:
            while True:
                try:
                    chunk = response.read1(_CHUNK_BYTES)
                except (OSError, http.client.HTTPException) as error:
                    raise _broken(url, done, total, _reason(error)) from error
                if not chunk:
                    return done
                file.write(chunk)
                done += len(chunk)
                progress.advance(len(chunk))
    except OSError as error:
        if error.errno in (errno.ENOSPC, errno.EDQUOT):
            raise DiskFull(
                f"The disk that holds {part.parent} is full. What came of the file is kept: free some space and pull "
                "again, or name another folder by HINDSIGHT_MODELS."
            ) from error
        raise


def _request(url: str, *, from_byte: int, etag: str | None) -> http.client.HTTPResponse:
    """The answer to a request for the file from that byte on; a server that can't is asked for all of it."""
    headers = {"User-Agent": "hindsight", "Accept-Encoding": "identity"}
    if from_byte:
        headers["Range"] = f"bytes={from_byte}-"
        if etag and not etag.startswith("W/"):
            headers["If-Range"] = etag
    try:
        # A new opener each time: the one behind urlopen goes on with the proxies of its first use.
        return urllib.request.build_opener().open(urllib.request.Request(url, headers=headers), timeout=TIMEOUT_S)
    except urllib.error.HTTPError as error:
        if from_byte and error.code == HTTPStatus.REQUESTED_RANGE_NOT_SATISFIABLE:
            return _request(url, from_byte=0, etag=None)
        raise _refused(url, error.code) from error
    except urllib.error.URLError as error:
        raise _unreachable(url, error.reason) from error
    except (OSError, http.client.HTTPException) as error:
        raise _unreachable(url, error) from error


def _range_of(url: str, response: http.client.HTTPResponse) -> tuple[int, int | None]:
    """The first byte of an answer, and the size of the whole file where the server says it."""
    if response.status == HTTPStatus.PARTIAL_CONTENT:
        found = _CONTENT_RANGE.fullmatch(response.headers.get("Content-Range", ""))
        if found is not None:
            return int(found[1]), int(found[2])
        response.close()
        raise SourceProblem(f"{_host(url)} sent a part of the file without saying which. {_ELSE}")
    length = response.headers.get("Content-Length", "")
    return 0, int(length) if length.isdecimal() else None


def _check_answer(url: str, response: http.client.HTTPResponse, total: int | None, expected_bytes: int | None) -> None:
    if response.headers.get_content_type() in ("text/html", "application/xhtml+xml"):
        raise ProxyProblem(
            f"{_host(url)} answered with a web page instead of the file: the login or the warning of a proxy, perhaps. "
            f"Open {url} in a browser to see it. {_ELSE}"
        )
    if None not in (total, expected_bytes) and total != expected_bytes:
        raise WrongBytes(
            f"The file at {url} has {total:,} bytes, and the published model has {expected_bytes:,}. It is another "
            f"file. {_ELSE}"
        )


def _check_space(part: Path, missing_bytes: int) -> None:
    free = shutil.disk_usage(part.parent).free
    if missing_bytes > free:
        raise DiskFull(
            f"The model needs {missing_bytes / 1e6:,.0f} MB more, and the disk that holds {part.parent} has "
            f"{free / 1e6:,.0f} MB. Free some space, or name another folder by HINDSIGHT_MODELS, and pull again."
        )


def _refused(url: str, status: int) -> PullError:
    """An answer that is no file."""
    if status == HTTPStatus.PROXY_AUTHENTICATION_REQUIRED:
        return _wants_login(url)
    if status in (HTTPStatus.NOT_FOUND, HTTPStatus.GONE):
        return SourceProblem(
            f"There is no file at {url} ({status}). Where HINDSIGHT_MODEL_MIRROR is set, it must hold the file by that "
            f"name. {_ELSE}"
        )
    phrase = http.client.responses.get(status, "not a status of HTTP")
    through = f", through the proxy {_proxy(url)}" if _proxy(url) else ""
    return SourceProblem(f"{_host(url)} answered {status} ({phrase}){through}. Pull again later. {_ELSE}")


def _unreachable(url: str, reason: object) -> PullError:
    """A connection that did not come about."""
    proxy, said = _proxy(url), _reason(reason)
    tunnel = re.search(r"Tunnel connection failed: (\d+)", said)
    if tunnel is not None:
        if int(tunnel[1]) == HTTPStatus.PROXY_AUTHENTICATION_REQUIRED:
            return _wants_login(url)
        return ProxyProblem(
            f"The proxy {proxy} won't connect to {_host(url)}: it answered {tunnel[1]}. Ask who runs it, or set "
            f"HINDSIGHT_MODEL_MIRROR to a source that it allows. {_ELSE}"
        )
    if isinstance(reason, ssl.SSLCertVerificationError):
        return ProxyProblem(
            f"The certificate of {_host(url)} is not trusted here ({reason.verify_message}). Most often a proxy opens "
            "encrypted traffic: set SSL_CERT_FILE to a file that holds its certificate, and pull again. "
            f"{_ELSE}"
        )
    if proxy is not None:
        return ProxyProblem(
            f"The proxy {proxy} (HTTPS_PROXY, HTTP_PROXY) can't be reached: {said}. Is it the right one? Set NO_PROXY "
            f"to {_host(url)} to go without. {_ELSE}"
        )
    if isinstance(reason, socket.gaierror):
        return SourceProblem(
            f"{_host(url)} can't be found: {said}. Is this machine online? Behind a proxy, set HTTPS_PROXY. {_ELSE}"
        )
    return SourceProblem(f"{_host(url)} can't be reached: {said}. Behind a proxy, set HTTPS_PROXY. {_ELSE}")


def _wants_login(url: str) -> PullError:
    return ProxyProblem(
        f"The proxy {_proxy(url)} wants a login (407). Set HTTPS_PROXY=http://user:password@host:port, and pull again. "
        f"{_ELSE}"
    )


def _broken(url: str, done: int, total: int | None, reason: str) -> BrokenOff:
    whole = f" of {total:,}" if total is not None else ""
    return BrokenOff(
        f"The connection to {_host(url)} broke off after {done:,}{whole} bytes: {reason}. What came is kept: pull "
        "again to go on from there."
    )


def _reason(error: object) -> str:
    if isinstance(error, TimeoutError):
        return f"no answer for {TIMEOUT_S:.0f} seconds"
    if isinstance(error, OSError) and error.strerror:
        return error.strerror
    return str(error) or type(error).__name__


def _host(url: str) -> str:
    return urlsplit(url).netloc.rpartition("@")[2]


def _proxy(url: str) -> str | None:
    """The proxy that is in use for this address, without its login; None where there is none."""
    parts = urlsplit(url)
    proxy = urllib.request.getproxies().get(parts.scheme)
    if proxy is None or urllib.request.proxy_bypass(parts.hostname or ""):
        return None
    return _host(proxy if "//" in proxy else f"//{proxy}")


def _note_path(part: Path) -> Path:
    return part.with_name(f"{part.name}.json")


def _read_note(part: Path) -> _PartNote | None:
    try:
        return _PartNote(**json.loads(_note_path(part).read_text("utf-8")))
    except (OSError, ValueError, TypeError):
        return None


def _write_note(part: Path, note: _PartNote) -> None:
    _note_path(part).write_text(json.dumps(asdict(note)), encoding="utf-8")
