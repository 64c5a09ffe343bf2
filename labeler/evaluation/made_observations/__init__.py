"""Observations made from a drive's truth by a noise model, to measure tracking and merging without a detector."""

from labeler.evaluation.made_observations.noise import MadeFrame, Noise, make_frames
from labeler.evaluation.made_observations.scene import NOTHING, Scene, SeenObjects, scene_of, seen_objects

__all__ = ["NOTHING", "MadeFrame", "Noise", "Scene", "SeenObjects", "make_frames", "scene_of", "seen_objects"]
