"""Pulling through a proxy, and past one that opens what is encrypted."""

from http import HTTPStatus

import pytest

from labeler.models.errors import ProxyProblem
from tests.labeler.models.model_server import CERTIFICATE, Behaviour, serving
from tests.labeler.models.pulling import FILE, Pulling


def test_a_proxy_is_obeyed(
    pulling: Pulling, behaviour: Behaviour, source: str, content: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HTTP_PROXY", source)
    pulling(mirror="http://models.invalid/yolox")
    assert behaviour.requests == [(f"http://models.invalid/yolox/{FILE}", None)]


@pytest.mark.parametrize(
    ("status", "says"),
    [
        (
            HTTPStatus.PROXY_AUTHENTICATION_REQUIRED,
            r"The proxy 127\.0\.0\.1:\d+ wants a login \(407\)\. Set HTTPS_PROXY",
        ),
        (HTTPStatus.FORBIDDEN, r"The proxy 127\.0\.0\.1:\d+ won't connect to models\.invalid: it answered 403"),
    ],
)
def test_a_proxy_that_refuses_is_named_without_its_password(
    pulling: Pulling,
    behaviour: Behaviour,
    source: str,
    monkeypatch: pytest.MonkeyPatch,
    status: HTTPStatus,
    says: str,
) -> None:
    behaviour.tunnel_status = status
    monkeypatch.setenv("HTTPS_PROXY", source.replace("//", "//me:secret@"))
    with pytest.raises(ProxyProblem, match=says) as caught:
        pulling(mirror="https://models.invalid")
    assert "secret" not in str(caught.value)
    assert behaviour.requests == [("models.invalid:443", None)]


def test_a_proxy_that_is_not_there_is_named(
    pulling: Pulling, unused_address: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HTTPS_PROXY", unused_address)
    with pytest.raises(ProxyProblem, match=r"The proxy 127\.0\.0\.1:\d+ .* can't be reached: Connection refused"):
        pulling(mirror="https://models.invalid")


def test_traffic_that_is_opened_is_named(pulling: Pulling, behaviour: Behaviour) -> None:
    with serving(behaviour, encrypted=True) as address, pytest.raises(ProxyProblem, match="set SSL_CERT_FILE"):
        pulling(mirror=address)


def test_a_certificate_of_the_users_is_trusted(
    pulling: Pulling, behaviour: Behaviour, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SSL_CERT_FILE", str(CERTIFICATE))
    with serving(behaviour, encrypted=True) as address:
        assert pulling(mirror=address).fresh
