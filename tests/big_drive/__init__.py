"""A big drive to measure the review page on, made by code: see :mod:`tests.big_drive.making`."""
