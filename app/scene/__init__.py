"""The 3D view beside the cameras: one private viser server per open page, reached only through the app's own origin."""
