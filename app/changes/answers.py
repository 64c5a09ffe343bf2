"""A change as an answer, written at once: no model is made of it."""

from collections.abc import Mapping
from typing import Any

from fastapi.responses import Response
from pydantic_core import to_json


def change_answer(values: Mapping[str, Any]) -> Response:
    """The values of a change as JSON. Tests read them back through its model."""
    return Response(to_json(values), media_type="application/json")
