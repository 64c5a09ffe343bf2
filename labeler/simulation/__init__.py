"""Drives with exact truth, rendered here from code alone: no downloaded mesh or picture.

From numbers to pictures: ``towns`` and ``dimensions`` say what towns are like, ``layout`` and ``blocks`` where
everything in one of them stands, ``world`` builds its meshes and the fleet of vehicles, ``lighting`` sets the sun, and
``renderer`` draws what cameras see. ``traffic`` moves the vehicles, ``lidar`` scans them, ``truth`` boxes them, and
``recording`` writes the drive. Everything follows from a seed.

What only this room needs (moderngl, embreex, eclipse-sumo) is in the extra ``simulation`` and is loaded when used.
"""
