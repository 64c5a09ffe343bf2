"""Keep and serve what the labeler made, so that a person can review it in a browser."""

__version__ = "0.1.0"
