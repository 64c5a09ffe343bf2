"""Runs the programs of Eclipse SUMO (https://eclipse.dev/sumo), which the extra ``simulation`` brings."""

import importlib.util
import os
import subprocess
from collections.abc import Mapping
from pathlib import Path
from typing import Literal

from labeler.simulation.errors import SimulationError

INSTALL_COMMAND = "pip install 'hindsight-labeler[simulation]'"
_TAIL_CHARACTERS = 600


def run_sumo(program: Literal["sumo", "netconvert"], options: Mapping[str, str]) -> None:
    """Run a program of SUMO to its end. ``options`` are named without dashes.

    SimulationError when SUMO is not installed, can't be started, or ends with an error, with its own words."""
    home = sumo_home()
    quiet = {"xml-validation": "never", "no-warnings": "true"}
    arguments = [word for name, value in (quiet | dict(options)).items() for word in (f"--{name}", value)]
    command = [str(home / "bin" / program), *arguments]
    environment = os.environ | {"SUMO_HOME": str(home)}
    try:
        ended = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    except OSError as error:
        raise SimulationError(
            f"SUMO's {program} can't be started ({error}). Install it again: {INSTALL_COMMAND}"
        ) from error
    if ended.returncode != 0:
        said = (ended.stderr or ended.stdout).strip()[-_TAIL_CHARACTERS:]
        raise SimulationError(f"SUMO's {program} ended with code {ended.returncode}: {said}")


def sumo_home() -> Path:
    """The folder of the installed package eclipse-sumo. SimulationError when it is not installed."""
    found = importlib.util.find_spec("sumo")
    places = list(found.submodule_search_locations or ()) if found is not None else []
    for place in places:
        if (Path(place) / "bin").is_dir():
            return Path(place)
    raise SimulationError(f"The simulation needs eclipse-sumo, which is not installed. Install it: {INSTALL_COMMAND}")
