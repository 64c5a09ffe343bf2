"""Whether a drive was recorded in a simulator, which a model trained there ought to know."""

from pathlib import Path

SIMULATION_FILE = "simulation.json"
"""What lies in the folder of a simulated drive, and says what it was made with."""


def is_simulated(root: Path) -> bool:
    """Whether the drive in this folder comes from a simulator."""
    return (root / SIMULATION_FILE).is_file()
