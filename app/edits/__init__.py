"""Corrections by people beside merges: splits, joins, classes, boxes, marks, comments; undo and redo of all."""
