"""``hindsight simulate``: record a simulated drive whose truth is known."""

from pathlib import Path
from typing import Annotated

import typer

from app.commands.terminal import TerminalProgress, say
from labeler.simulation.recording import SimulationConfig, simulate_drive
from labeler.simulation.towns import TOWNS


def simulate(
    out: Annotated[Path, typer.Argument(help="Folder to make; it must not be there yet.", show_default=False)],
    frames: Annotated[int, typer.Option(min=1, help="How many moments to record.")] = 100,
    vehicles: Annotated[int, typer.Option(min=1, help="How many vehicles drive, the ego car among them.")] = 60,
    seed: Annotated[int, typer.Option(min=0, help="Everything follows from it: town, traffic, light, noise.")] = 0,
    rate: Annotated[float, typer.Option(min=0.5, max=50, help="Moments a second.")] = 10.0,
    width: Annotated[int, typer.Option(min=64, max=4096, help="Width of the images in pixels.")] = 720,
    height: Annotated[int, typer.Option(min=64, max=4096, help="Height of the images in pixels.")] = 360,
    town: Annotated[str, typer.Option(help=f"Kind of town: {', '.join(TOWNS)}.")] = "grid",
    light: Annotated[
        str | None,
        typer.Option(help="morning, noon, evening or overcast. (default: the seed chooses)", show_default=False),
    ] = None,
    parked: Annotated[float, typer.Option(min=0, max=1, help="Share of the parking slots that are taken.")] = 0.6,
    quality: Annotated[int, typer.Option(min=1, max=100, help="JPEG quality of the images.")] = 90,
    lidar_channels: Annotated[int, typer.Option(min=32, max=255, help="Beams of the LiDAR.")] = 64,
    lidar_columns: Annotated[int, typer.Option(min=90, max=4096, help="Readings of each beam in a turn.")] = 1440,
    semantic: Annotated[
        bool, typer.Option("--semantic", help="Write the class of each pixel beside each image, for training.")
    ] = False,
    truth_only: Annotated[
        bool, typer.Option("--truth-only", help="Write no images and no sweeps: for `hindsight benchmark merges`.")
    ] = False,
) -> None:
    """Record a simulated drive: four cameras, LiDAR, and the truth. Needs the extra `simulation`."""
    config = SimulationConfig(
        seed=seed,
        frames=frames,
        vehicles=vehicles,
        rate_hz=rate,
        width_px=width,
        height_px=height,
        town=town,
        light=light,
        parked_share=parked,
        jpeg_quality=quality,
        lidar_channels=lidar_channels,
        lidar_columns=lidar_columns,
        semantic=semantic,
        truth_only=truth_only,
    )
    with TerminalProgress() as progress:
        simulate_drive(out, config, progress)
    if truth_only:
        say(f"{out}: the truth of {frames} frames. Use it: hindsight benchmark merges {out}")
        return
    say(f"{out}: {frames} frames, 4 cameras, LiDAR and truth. Look at it: hindsight demo {out}")
