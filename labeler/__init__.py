"""Label a recorded drive by itself: detect, track, merge across cameras, propagate.

One room per step, in the order in which the data flows: ``drive`` (what was recorded), ``detection``, ``tracking``,
``lidar``, ``identity``, ``propagation``; ``pipeline`` runs them. This package knows no web and no SQL: files and arrays
in, arrays and files out. A quick start::

    from labeler.drive import open_drive

    drive = open_drive("path/to/drive")
"""
