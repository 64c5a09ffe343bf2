"""The root of every error that this project raises on purpose.

A message says what was wrong, where, and what to do. The command line and the web page print it as it is.
"""


class HindsightError(Exception):
    """Something a user can act on. ``str(error)`` is a full sentence for that user."""
