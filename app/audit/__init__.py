"""How far the labels of a drive can be believed without truth: what came out when some were hidden and found again."""
