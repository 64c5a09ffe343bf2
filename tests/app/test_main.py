"""The app as a whole: its description, its errors, its page."""

import gzip
from pathlib import Path

import pytest
from fastapi.routing import APIRoute

from app.cli import openapi_text
from app.main import create_app
from app.settings import Settings
from tests.app.browser import Browser, browser_on

OPENAPI = Path(__file__).parents[2] / "frontend" / "openapi.json"


def test_the_description_that_the_pages_client_is_made_from_is_current() -> None:
    assert OPENAPI.read_text(encoding="utf-8") == openapi_text(), "run `make openapi` and commit what it writes"


def test_every_operation_has_a_name_of_its_own(settings: Settings) -> None:
    paths = create_app(settings).openapi()["paths"]
    names = [operation["operationId"] for path in paths.values() for operation in path.values()]
    assert len(names) == len(set(names))
    assert all(name.isidentifier() for name in names)


def test_health(client: Browser) -> None:
    assert client.get("/api/health").json() == {"version": "0.1.0", "status": "ok"}


@pytest.mark.parametrize(
    ("method", "path", "status", "code"),
    [
        ("GET", "/api/drives/5", 404, "not_found"),
        ("GET", "/api/no/such/thing", 404, "not_found"),
        ("GET", "/assets/gone.js", 404, "not_found"),
        ("GET", "/api/drives/five", 422, "invalid_request"),
        ("POST", "/api/drives", 422, "invalid_request"),  # no body
        ("DELETE", "/api/drives", 405, "method_not_allowed"),
    ],
)
def test_every_error_has_one_form(client: Browser, method: str, path: str, status: int, code: str) -> None:
    answer = client.request(method, path)
    assert answer.status_code == status
    detail = answer.json()["detail"]
    assert detail["code"] == code
    assert set(detail) == {"code", "message"}
    assert detail["message"].endswith(".")


def test_an_unexpected_error_tells_no_secrets(settings: Settings) -> None:
    app = create_app(settings)

    def fail() -> None:
        raise ValueError("secret")

    app.router.routes.insert(0, APIRoute("/api/fail", fail))
    with browser_on(app) as client:
        answer = client.get("/api/fail")
    assert (answer.status_code, answer.json()["detail"]["code"]) == (500, "internal_error")
    assert "secret" not in answer.text


def test_foreign_hosts_are_refused(client: Browser) -> None:
    assert client.get("/api/health", headers={"host": "evil.example"}).status_code == 421
    assert client.post("/api/drives", json={"path": "/"}, headers={"origin": "http://evil.example"}).status_code == 403


@pytest.mark.parametrize(
    ("host", "allowed", "asked", "status"),
    [
        ("192.168.1.5", (), "192.168.1.5:8000", 200),  # its own address
        ("0.0.0.0", (), "192.168.1.5:8000", 421),  # which of its names are right, nobody knows
        ("0.0.0.0", ("labels.example",), "labels.example", 200),
    ],
)
def test_names_that_the_server_answers_to(
    settings: Settings, host: str, allowed: tuple[str, ...], asked: str, status: int
) -> None:
    public = settings.model_copy(update={"host": host, "allowed_hosts": allowed})
    with browser_on(create_app(public)) as client:
        assert client.get("/api/health", headers={"host": asked}).status_code == status


@pytest.fixture
def static_folder(tmp_path: Path) -> Path:
    """A page as Vite builds it."""
    folder = tmp_path / "static"
    (folder / "assets").mkdir(parents=True)
    (folder / "index.html").write_text("<title>Hindsight</title>")
    (folder / "assets" / "index-abc123.js").write_text("export {}")
    (folder / "favicon.svg").write_text("<svg/>")
    (tmp_path / "secret.txt").write_text("secret")
    return folder


@pytest.mark.parametrize(
    ("path", "status", "content", "cache"),
    [
        ("/", 200, "<title>Hindsight</title>", "no-cache"),
        ("/drives/3?frame=7", 200, "<title>Hindsight</title>", "no-cache"),  # the page's own address
        ("/assets/index-abc123.js", 200, "export {}", "public, max-age=31536000, immutable"),
        ("/favicon.svg", 200, "<svg/>", "no-cache"),
        ("/..%2Fsecret.txt", 200, "<title>Hindsight</title>", "no-cache"),  # outside of the page there is nothing
        ("/%00", 200, "<title>Hindsight</title>", "no-cache"),
    ],
)
def test_the_page(settings: Settings, static_folder: Path, path: str, status: int, content: str, cache: str) -> None:
    with browser_on(create_app(settings, static_folder=static_folder)) as client:
        answer = client.get(path)
    assert (answer.status_code, answer.text, answer.headers["cache-control"]) == (status, content, cache)
    assert "default-src 'self'" in answer.headers["content-security-policy"]


@pytest.mark.parametrize(("reads", "encoding"), [("gzip, br", "gzip"), ("br", None)])
def test_files_are_sent_compressed_to_who_reads_that(
    settings: Settings, static_folder: Path, reads: str, encoding: str | None
) -> None:
    compressed = static_folder / "assets" / "index-abc123.js.gz"
    compressed.write_bytes(gzip.compress(b"export {}"))
    with browser_on(create_app(settings, static_folder=static_folder)) as client:
        answer = client.get("/assets/index-abc123.js", headers={"Accept-Encoding": reads})
    assert answer.text == "export {}"
    assert answer.headers.get("content-encoding") == encoding
    assert answer.headers["content-type"].startswith("text/javascript")
    assert answer.headers["vary"] == "Accept-Encoding"


def test_a_page_that_is_not_built_says_how_to_build_it(settings: Settings, tmp_path: Path) -> None:
    with browser_on(create_app(settings, static_folder=tmp_path / "nothing")) as client:
        answer = client.get("/drives/3")
    assert answer.status_code == 503
    assert "make frontend" in answer.text
