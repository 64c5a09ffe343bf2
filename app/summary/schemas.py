"""What the page learns about a drive's labels as a whole, compact enough to count any choice of them in the browser."""

from pydantic import BaseModel, Field


class LabelHistogram(BaseModel):
    """Numbers of labels that are alike, a row each in columns of equal length.

    Score bins are hundredths from 0 to 100, where 100 is a score of 1. Distance bins go from one edge to the next, the
    last one on and on; null is unknown, for the score and for the distance.
    """

    class_names: list[str]
    distance_edges_m: list[float] = Field(description="Where distance bins begin.")
    sources: list[str] = Field(description="auto, propagated, human; by number in source.")
    class_id: list[int]
    source: list[int]
    score_bin: list[int | None]
    distance_bin: list[int | None]
    count: list[int]
    own_score_bin: list[int | None] = Field(description="What the detector said itself, another table.")
    own_source: list[int] = Field(description="Where the labels of own_score_bin come from.")
    own_count: list[int]
    revision: int
