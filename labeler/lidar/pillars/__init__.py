"""3D boxes from a pillar network on painted points (PointPillars on PointPainting's clouds), for each camera direction.

One network serves all cameras: the cloud is turned so that the camera looks along x, and told as heights above the
ground, so that neither the mounting of the rig nor a slope matters. :func:`direction_cloud` makes that cloud,
:func:`pillars_of` groups it, the network (ONNX) says for each cell what stands there, and :func:`decode` makes boxes of
that. Training uses the same functions.

Sources: A. H. Lang et al., PointPillars, CVPR 2019 (arXiv:1812.05784); S. Vora et al., PointPainting, CVPR 2020
(arXiv:1911.10150); T. Yin et al., Center-based 3D Object Detection and Tracking, CVPR 2021 (arXiv:2006.11275).
"""
