"""Evaluation: how the labels of a drive compare with its truth."""
