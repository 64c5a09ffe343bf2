"""Errors that answer a request, and the one form in which all of them leave the server.

The form is ``{"detail": {"code": "machine_word", "message": "a full sentence for the user"}}``.
"""

import logging
from http import HTTPStatus

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from pydantic import BaseModel
from starlette.exceptions import HTTPException

from labeler.errors import HindsightError

logger = logging.getLogger(__name__)


class ErrorDetail(BaseModel):
    """``code`` is for programs, ``message`` a full sentence for the user: what, where, what to do."""

    code: str
    message: str


class ErrorBody(BaseModel):
    """What every answer other than 2xx holds."""

    detail: ErrorDetail


class AppError(HindsightError):
    """A request that can't be fulfilled. Subclasses say the HTTP status and the code."""

    status = HTTPStatus.BAD_REQUEST
    code = "bad_request"


class NotFound(AppError):
    status = HTTPStatus.NOT_FOUND
    code = "not_found"


class InvalidRequest(AppError):
    """Values that do not go together."""

    status = HTTPStatus.UNPROCESSABLE_ENTITY
    code = "invalid_request"


class CannotLink(AppError):
    """Two tracks of one camera that share a frame can never be one object."""

    status = HTTPStatus.CONFLICT
    code = "cannot_link"


class ClassesDiffer(AppError):
    """People gave different classes to objects that are to become one."""

    status = HTTPStatus.CONFLICT
    code = "classes_differ"


class Stale(AppError):
    """Somebody else has changed the same objects since the page read them."""

    status = HTTPStatus.CONFLICT
    code = "stale"


class Conflict(AppError):
    """The state of things does not allow it now."""

    status = HTTPStatus.CONFLICT
    code = "conflict"


class LocalPathsForbidden(AppError):
    status = HTTPStatus.FORBIDDEN
    code = "local_paths_forbidden"


class UnusableDrive(AppError):
    """The drive's files can't be used."""

    status = HTTPStatus.UNPROCESSABLE_ENTITY
    code = "unusable_drive"


class UnusableModel(AppError):
    """No model is named, or there is no such file."""

    status = HTTPStatus.UNPROCESSABLE_ENTITY
    code = "unusable_model"


class BadArchive(AppError):
    """An upload that is not an archive, or one with members that must not be unpacked."""

    code = "bad_archive"


class UploadIncomplete(AppError):
    """The sender went away in the middle."""

    code = "upload_incomplete"


class UploadTooLarge(AppError):
    status = HTTPStatus.REQUEST_ENTITY_TOO_LARGE
    code = "upload_too_large"


class DiskFull(AppError):
    status = HTTPStatus.INSUFFICIENT_STORAGE
    code = "disk_full"


def error_response(status: int, code: str, message: str) -> JSONResponse:
    """An answer in the form of :class:`ErrorBody`."""
    body = ErrorBody(detail=ErrorDetail(code=code, message=message))
    return JSONResponse(body.model_dump(), status_code=status)


def install_error_handlers(app: FastAPI) -> None:
    """Let every error leave in one form."""

    @app.exception_handler(AppError)
    def on_app_error(_request: Request, error: AppError) -> JSONResponse:
        return error_response(error.status, error.code, str(error))

    @app.exception_handler(HindsightError)
    def on_labeler_error(_request: Request, error: HindsightError) -> JSONResponse:
        return error_response(HTTPStatus.UNPROCESSABLE_ENTITY, "unusable_input", str(error))

    @app.exception_handler(RequestValidationError)
    def on_invalid_request(_request: Request, error: RequestValidationError) -> JSONResponse:
        faults = "; ".join(
            f"{'.'.join(str(part) for part in fault['loc'])}: {fault['msg']}" for fault in error.errors()
        )
        message = f"The request is not valid: {faults}."
        return error_response(HTTPStatus.UNPROCESSABLE_ENTITY, "invalid_request", message)

    @app.exception_handler(HTTPException)
    def on_http_error(_request: Request, error: HTTPException) -> JSONResponse:
        code = HTTPStatus(error.status_code).phrase.lower().replace(" ", "_")
        response = error_response(error.status_code, code, f"{error.detail}.".replace("..", "."))
        response.headers.update(error.headers or {})
        return response

    @app.exception_handler(Exception)
    def on_unexpected_error(request: Request, error: Exception) -> JSONResponse:
        logger.error("%s %s failed", request.method, request.url.path, exc_info=error)
        message = f"The server failed at {request.method} {request.url.path}. Its log says why."
        return error_response(HTTPStatus.INTERNAL_SERVER_ERROR, "internal_error", message)
