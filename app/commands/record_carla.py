"""``hindsight record-carla``: record a drive from a CARLA server, with the truth."""

from pathlib import Path
from typing import Annotated

import typer

from app.commands.terminal import INTERRUPTED, TerminalProgress, say
from labeler.carla.config import LONGEST_S, SHORTEST_S, CarlaConfig
from labeler.carla.connection import import_carla
from labeler.carla.recording import record_drive


def record_carla(
    out: Annotated[Path, typer.Argument(help="Folder to make; it must not be there yet.", show_default=False)],
    host: Annotated[str, typer.Option(help="Where the CARLA server runs.")] = "127.0.0.1",
    port: Annotated[int, typer.Option(min=1, max=65535, help="Port of the CARLA server.")] = 2000,
    town: Annotated[str, typer.Option(help="Map of the server.")] = "Town10HD",
    vehicles: Annotated[int, typer.Option(min=1, help="How many vehicles to put there, the ego car among them.")] = 60,
    frames: Annotated[int, typer.Option(min=1, help="How many moments to record.")] = 1000,
    interval: Annotated[float, typer.Option(min=SHORTEST_S, max=LONGEST_S, help="Seconds between two moments.")] = 0.1,
    distance: Annotated[float, typer.Option(min=1, help="Metres up to which vehicles have a 3D box.")] = 80.0,
    seed: Annotated[int, typer.Option(min=0, help="Of places, models, colours and turns.")] = 0,
    width: Annotated[int, typer.Option(min=64, max=4096, help="Width of the images in pixels.")] = 720,
    height: Annotated[int, typer.Option(min=64, max=4096, help="Height of the images in pixels.")] = 360,
    quality: Annotated[int, typer.Option(min=1, max=100, help="JPEG quality of the images.")] = 90,
    lidar_channels: Annotated[int, typer.Option(min=1, max=255, help="Beams of the LiDAR.")] = 64,
    lidar_columns: Annotated[int, typer.Option(min=90, max=4096, help="Readings of each beam in a turn.")] = 1024,
    traffic_port: Annotated[int, typer.Option(min=1, max=65535, help="Port for CARLA's traffic manager.")] = 8000,
    timeout: Annotated[float, typer.Option(min=1, help="Seconds to wait for the server or a sensor.")] = 60.0,
) -> None:
    """Record a drive from a CARLA server: four cameras, LiDAR, and the truth. Needs the extra `carla`."""
    config = CarlaConfig(
        host=host,
        port=port,
        town=town,
        vehicles=vehicles,
        frames=frames,
        interval_s=interval,
        seed=seed,
        distance_m=distance,
        width_px=width,
        height_px=height,
        jpeg_quality=quality,
        lidar_channels=lidar_channels,
        lidar_columns=lidar_columns,
        traffic_port=traffic_port,
        timeout_s=timeout,
    )
    carla = import_carla()
    try:
        with TerminalProgress() as progress:
            recorded = record_drive(carla, out, config, progress)
    except KeyboardInterrupt as error:
        for warning in error.args:
            say(f"Warning: {warning}")
        kept = f"The moments recorded until then are in {out}." if out.exists() else "Nothing was recorded."
        say(f"Stopped. {kept}")
        raise typer.Exit(INTERRUPTED) from error
    for warning in recorded.warnings:
        say(f"Warning: {warning}")
    say(
        f"{out}: {recorded.moments} frames of CARLA {recorded.version.text}, 4 cameras, LiDAR and truth. "
        f"Look at it: hindsight demo {out}"
    )
