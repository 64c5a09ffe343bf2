"""What the labeler found: tracks, observations, labels and 3D boxes."""
