"""Commands that look at devices, connect them and let go of them."""

import time
from typing import Annotated

import typer
from rich.console import Console
from rich.live import Live

from stepramp.command_line.commands import FAMILY_HELP, Find, command
from stepramp.command_line.completion import completing, family_names
from stepramp.command_line.output import Format, Rows, as_table, show, tell, warn, write_csv
from stepramp.command_line.visible import visible_json
from stepramp.command_line.where import Where
from stepramp.errors import Rejected, Rejection
from stepramp.http_api.devices_models import DeviceAnswer, DevicesAnswer

LONGEST_WATCH_S = 86_400
SEEN_EVERY_S = 0.2
AXIS_COLUMNS = ("device", "axis", "state", "position [steps]", "target [steps]", "speed [steps/s]", "limits [steps]")


def add(app: typer.Typer) -> None:
    """Add the commands to the program."""
    command(app, "ports", example="stepramp ports")(ports)
    command(app, "devices", example="stepramp devices --format json")(devices)
    command(app, "connect", example="stepramp connect sim://")(connect)
    command(app, "status", example="stepramp status --port sim://")(status)
    command(app, "disconnect", example="stepramp disconnect --port sim://")(disconnect)


def ports(where: Where, format: Format = "table") -> None:
    """List what can be connected to, and the families that a controller there may be of. Nothing is opened."""
    answer = where.client.ports()
    rows = [(each.port, each.name, ", ".join(each.families)) for each in answer.ports]
    show(format, answer, Rows(("port", "name", "families"), rows))


def devices(where: Where, format: Format = "table") -> None:
    """List the devices that a server has connected, or had until they were lost."""
    answer = where.client.devices()
    if where.is_alone:
        tell("no server of this machine runs: nothing is connected")
    show(format, answer, listing(answer))


def connect(
    where: Where,
    port: Annotated[str, typer.Argument(metavar="PORT", help="what `stepramp ports` lists; sim:// is a virtual one")],
    family: Annotated[
        str | None,
        typer.Option("--family", metavar="NAME", help=FAMILY_HELP, autocompletion=completing(family_names)),
    ] = None,
    format: Format = "table",
) -> None:
    """Have the server connect to a controller, and keep it connected. Nothing moves."""
    answer = where.client.connect(port, family)
    if where.is_alone:
        tell("no server of this machine runs: it was connected for a moment only, as for each command")
    show(format, answer, listing(DevicesAnswer(devices=[answer])))


def disconnect(where: Where, find: Find, format: Format = "table") -> None:
    """Have the server let go of a device; refused while a motor of it moves."""
    device = find()
    show(format, where.client.disconnect(device.id), Rows(("let go of",), [(device.port,)]))


def status(
    where: Where,
    find: Find,
    watch: Annotated[bool, typer.Option("--watch", help="show it as it changes, until Ctrl+C")] = False,
    for_s: Annotated[float | None, typer.Option("--for", help="watch for so long [s]")] = None,
    format: Format = "table",
) -> None:
    """Show where the axes of a device are, and what they do."""
    if for_s is not None and not watch:
        raise Rejected([Rejection("--for", for_s, "nothing without --watch")])
    if for_s is not None and not 0 <= for_s <= LONGEST_WATCH_S:
        raise Rejected([Rejection("--for", for_s, f"a number from 0 to {LONGEST_WATCH_S:,} s")])
    device = find()
    warn([device.message] if device.message else [])
    if watch:
        _watch(where, device, for_s, format)
    else:
        show(format, device, axes_of(device))


def _watch(where: Where, device: DeviceAnswer, for_s: float | None, format: str) -> None:
    """Show each change: in place at a terminal, else a line, or lines, each."""
    until_s = None if for_s is None else time.monotonic() + for_s
    console, shown = Console(highlight=False), None
    is_live = format == "table" and console.is_terminal
    with Live(as_table(axes_of(device)), console=console, auto_refresh=False) if is_live else _Nothing() as live:
        while until_s is None or time.monotonic() < until_s:
            now = where.client.device(device.id)
            rows = [list(row) for row in axes_of(now).rows]
            if rows != shown:
                if live is not None:
                    live.update(as_table(axes_of(now)), refresh=True)
                elif format == "json":
                    print(visible_json(now.model_dump_json(by_alias=True)), flush=True)
                else:
                    # One header for all of them.
                    listed = Rows(AXIS_COLUMNS, rows)
                    _print_more(listed) if shown is not None else write_csv(listed)
                shown = rows
            time.sleep(SEEN_EVERY_S)


def _print_more(rows: Rows) -> None:
    for row in rows.rows:
        print(",".join("" if value is None else str(value) for value in row), flush=True)


class _Nothing:
    """In place of what is shown at a terminal."""

    def __enter__(self) -> None:
        return None

    def __exit__(self, *_: object) -> None:
        pass


def listing(answer: DevicesAnswer) -> Rows:
    """Return devices as rows."""
    return Rows(
        ("device", "port", "name", "family", "state", "axes", "version", "on trial"),
        [
            (
                each.id,
                each.port,
                each.name,
                each.family,
                each.state,
                len(each.axes),
                each.firmware_version,
                each.on_trial,
            )
            for each in answer.devices
        ],
    )


def axes_of(device: DeviceAnswer) -> Rows:
    """Return the axes of a device as rows."""
    return Rows(
        AXIS_COLUMNS,
        [
            (
                device.id,
                axis.axis,
                str(axis.state),
                axis.position_steps if axis.position_told else None,
                axis.target_steps if axis.position_told else None,
                axis.speed_steps_per_s,
                _limits(axis.lowest_steps, axis.highest_steps),
            )
            for axis in device.axes
        ],
        f"{device.name} at {device.port}",
    )


def _limits(lowest: int | None, highest: int | None) -> str | None:
    if lowest is None and highest is None:
        return None
    return f"{'' if lowest is None else lowest}…{'' if highest is None else highest}"
