"""Where tracked objects were, seen from above: their 3D boxes in one frame for the whole drive."""
