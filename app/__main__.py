"""``python -m app`` is ``hindsight``."""

from app.cli import main

main()
