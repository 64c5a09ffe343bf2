"""Decisions of people, append-only; they survive labelling the drive again."""
