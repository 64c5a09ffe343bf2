"""What can keep a drive from being evaluated."""

from http import HTTPStatus

from app.errors import AppError


class NoTruth(AppError):
    """The drive comes without true boxes in its images."""

    status = HTTPStatus.NOT_FOUND
    code = "no_truth"
