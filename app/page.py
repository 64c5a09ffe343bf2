"""The web page: the files of the frontend's build, and its index for every address that the page itself knows.

Files below ``assets/`` carry a hash of their content in their name, so browsers may keep them for ever; the index must
be asked for anew each time. The build puts a compressed copy, ``NAME.gz``, beside each larger file; browsers that can
read it get it.
"""

from html import escape
from mimetypes import guess_type
from pathlib import Path

from fastapi import FastAPI, Request
from fastapi.responses import FileResponse, HTMLResponse, Response
from starlette.exceptions import HTTPException

STATIC_FOLDER = Path(__file__).parent / "static"
FOR_EVER = "public, max-age=31536000, immutable"
NOT_PAGE = ("api", "scene", "assets")


def install_page(app: FastAPI, folder: Path = STATIC_FOLDER) -> None:
    """Answer every address that no other route of ``app`` answers; call it last."""

    @app.get("/{path:path}", include_in_schema=False)
    def get_page(path: str, request: Request) -> Response:
        file = _file(folder, path)
        if file is not None:
            return _answer(file, request, cache=FOR_EVER if path.startswith("assets/") else "no-cache")
        if path.split("/", 1)[0] in NOT_PAGE:
            raise HTTPException(404, f"There is nothing at /{path}")
        index = folder / "index.html"
        if not index.is_file():
            return HTMLResponse(_not_built(folder), status_code=503, headers={"Cache-Control": "no-store"})
        return FileResponse(index, headers={"Cache-Control": "no-cache"})


def _file(folder: Path, path: str) -> Path | None:
    """The file of the build at that address; None where there is none, or where it would lie outside."""
    if not path or "\0" in path:
        return None
    file = (folder / path).resolve()
    return file if file.is_relative_to(folder.resolve()) and file.is_file() else None


def _answer(file: Path, request: Request, *, cache: str) -> Response:
    """The file, or its compressed copy where there is one and the browser reads it."""
    headers = {"Cache-Control": cache}
    compressed = file.with_name(file.name + ".gz")
    if not compressed.is_file():
        return FileResponse(file, headers=headers)
    headers["Vary"] = "Accept-Encoding"
    if "gzip" not in request.headers.get("accept-encoding", ""):
        return FileResponse(file, headers=headers)
    headers["Content-Encoding"] = "gzip"
    return FileResponse(compressed, headers=headers, media_type=guess_type(file.name)[0])


def _not_built(folder: Path) -> str:
    return f"""<!doctype html>
<html lang="en">
<meta charset="utf-8">
<title>Hindsight: the page is not built</title>
<h1>The page is not built</h1>
<p>The server runs, but there is no page in <code>{escape(str(folder))}</code>.</p>
<p>In a checkout of Hindsight, run <code>make frontend</code> and load this page again. Installed packages bring the
page with them.</p>
</html>
"""
