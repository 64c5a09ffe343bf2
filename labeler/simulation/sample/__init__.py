"""The sample drive that ships with the project: see README.md in this folder for what it is and how it was made."""

from pathlib import Path

SAMPLE_NAME = "turn-at-a-crossing"


def sample_drive() -> Path:
    """The folder of the sample drive, in the native format. It must not be written to."""
    return Path(__file__).parent / SAMPLE_NAME
