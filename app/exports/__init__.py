"""Datasets that go out."""
