"""The measures of a street that every part of a town shares, in metres. Seen across: centre line, two lanes, gutter,
kerb or parking bay, sidewalk. Seen along, from a junction's centre: crossing, stop line, parking bay."""

LANE_WIDTH_M = 3.5
LANES_EACH_WAY = 2
GUTTER_M = 0.3
HALF_CARRIAGEWAY_M = LANES_EACH_WAY * LANE_WIDTH_M + GUTTER_M
"""From a street's centre line to the kerb, where there is no parking bay."""
BAY_DEPTH_M = 2.4
"""How far a parking bay reaches beyond the carriageway's edge."""
KERB_HEIGHT_M = 0.15
"""How high the sidewalks lie above the streets."""
CROSSING_START_M = HALF_CARRIAGEWAY_M + 1.0
CROSSING_WIDTH_M = 3.0
STOP_LINE_M = CROSSING_START_M + CROSSING_WIDTH_M + 1.0
"""From a junction's centre to the middle of its stop lines."""
STOP_LINE_WIDTH_M = 0.4
BAY_START_M = STOP_LINE_M + 5.0
"""From a junction's centre to the nearest end of a parking bay."""
SLOT_LENGTH_M = 6.2
SLOT_WIDTH_M = 2.3
BORDER_DEPTH_M = 34.0
"""How deep the ring of blocks outside of the outermost streets is."""
LAMP_SPACING_M = 0.32
"""Between the lamps of a signal, one above the other: green, yellow, red."""
