"""Commands that write to a controller: they show what differs, and ask."""

import sys
from typing import Annotated

import typer

from stepramp.command_line.commands import Find, command
from stepramp.command_line.exit_codes import FAILED
from stepramp.command_line.files import DesignFiles, designs_of
from stepramp.command_line.output import Format, FormatName, Rows, as_table, progress_asked, show, tell, warn
from stepramp.command_line.visible import visible
from stepramp.command_line.where import Where
from stepramp.errors import Rejected, Rejection
from stepramp.http_api.devices_models import DeviceAnswer, PreviewAnswer, PushedAnswer

Yes = Annotated[bool, typer.Option("--yes", "-y", help="don't ask; needed where there is no terminal to ask at")]


def add(app: typer.Typer) -> None:
    """Add the commands to the program."""
    command(app, "push", example="stepramp push design.json --port sim:// --yes")(push)
    command(app, "keep", example="stepramp keep --port sim://")(keep)
    command(app, "rollback", example="stepramp rollback --port sim://")(rollback)
    command(app, "backups", example="stepramp backups --port /dev/ttyUSB0 --family grbl")(backups)
    command(app, "restore", example="stepramp restore --port sim:// --yes")(restore)


def push(
    where: Where,
    designs: DesignFiles,
    find: Find,
    to_axis: Annotated[
        int | None, typer.Option("--to-axis", help="which axis one design is for, the others keep theirs; else 0")
    ] = None,
    on_trial: Annotated[
        bool, typer.Option("--try", help="use them, but don't store them: see keep and rollback")
    ] = False,
    yes: Yes = False,
    format: Format = "table",
) -> None:
    """Have a controller use a design's ramp, or those of all axes, and read it back. Nothing moves.

    What differs is shown first, and you are asked. Several designs are those of all axes, axis 0 first.
    """
    refuse_unasked(yes)
    planned = designs_of(designs)
    device = find()
    one, many = (planned[0], None) if len(planned) == 1 else (None, planned)
    preview = where.client.preview_push(device.id, one, to_axis=to_axis, axes=many)
    warn(preview.warnings)
    if format == "table" or not yes:
        _show_differences(preview)
    if preview.same and (on_trial or not device.on_trial):
        tell("the controller has exactly these ramps already: nothing was sent")
        return
    if not yes and not asked(f"Push to {device.name} at {device.port}?"):
        raise typer.Exit(FAILED)
    with progress_asked("Push", lambda: _part_done(where, device.id)):
        pushed = where.client.push(device.id, one, to_axis=to_axis, axes=many, mode="try" if on_trial else "keep")
    show(format, pushed, _items(pushed))
    for warning in pushed.warnings:
        if warning not in preview.warnings:
            warn([warning])
    if not pushed.verified:
        tell("what was read back is not what was sent")
        raise typer.Exit(FAILED)
    tell(f"read back as sent, {'stored' if pushed.kept else 'on trial'}")


def refuse_unasked(yes: bool) -> None:
    """Refuse what would have to be asked where nobody can be."""
    if not yes and not (sys.stdin.isatty() and sys.stderr.isatty()):
        raise Rejected([Rejection("--yes", None, "--yes, since there is no terminal to ask at")])


def asked(question: str) -> bool:
    """Ask at the terminal; anything but yes is no."""
    print(f"{visible(question)} [y/N] ", end="", file=sys.stderr, flush=True)
    is_yes = sys.stdin.readline().strip().lower() in ("y", "yes")
    if not is_yes:
        tell("nothing was sent")
    return is_yes


def _show_differences(preview: PreviewAnswer) -> None:
    from rich.console import Console  # noqa: PLC0415

    differing = [each for each in preview.items if each.differs]
    rows = [(each.axis, each.name, each.on_device, each.to_send, each.unit) for each in differing]
    columns = ("axis", "figure", "on the device", "to be sent", "unit")
    console = Console(stderr=True, highlight=False, width=None if sys.stderr.isatty() else 200)
    console.print(as_table(Rows(columns, rows, f"{len(differing)} of {len(preview.items)} figures differ")))


def _items(pushed: PushedAnswer) -> Rows:
    return Rows(
        ("axis", "figure", "asked for", "sent", "read back", "unit"),
        [(each.axis, each.name, each.requested, each.sent, each.read_back, each.unit) for each in pushed.items],
    )


def _part_done(where: Where, device_id: str) -> float | None:
    progress = where.client.device(device_id).progress
    if progress is None or not progress.bytes_total:
        return None
    return progress.bytes_done / progress.bytes_total


def keep(where: Where, find: Find, format: Format = "table") -> None:
    """Store the ramps and settings that a controller uses on trial."""
    kept = where.client.keep(find().id)
    warn(kept.remarks)
    _told(kept, "stored", format)


def rollback(where: Where, find: Find, format: Format = "table") -> None:
    """Drop the ramps and settings that are on trial: the stored ones are used again."""
    _told(where.client.roll_back(find().id), "rolled back", format)


def backups(
    where: Where,
    find: Find,
    of_all: Annotated[
        bool, typer.Option("--all", help="of all devices that there ever were, connected or not, with what each is of")
    ] = False,
    format: Format = "table",
) -> None:
    """List what was saved of a device before it was written to."""
    if of_all:
        every = where.client.all_backups()
        warn(every.unreadable)
        rows = [(each.name, one.name, one.bytes) for each in every.sources for one in each.backups]
        show(format, every, Rows(("of", "backup", "bytes"), rows))
        return
    answer = where.client.backups(find().id)
    warn(answer.unreadable)
    show(format, answer, Rows(("backup", "bytes"), [(each.name, each.bytes) for each in answer.backups]))


def restore(
    where: Where,
    find: Find,
    backup: Annotated[
        str | None,
        typer.Option("--backup", metavar="NAME", help="one of `stepramp backups`; else what was stored before"),
    ] = None,
    of: Annotated[
        str | None,
        typer.Option(
            "--of", metavar="NAME", help="what the backup is of, as `stepramp backups --all` tells; else of this device"
        ),
    ] = None,
    yes: Yes = False,
    format: Format = "table",
) -> None:
    """Bring back what a controller had stored before, or a backup of it. Nothing moves."""
    if of is not None and backup is None:
        raise Rejected([Rejection("--of", of, "nothing without --backup")])
    refuse_unasked(yes)
    device = find()
    what = "what was stored before" if backup is None else f"the backup {backup}{'' if of is None else f' of {of}'}"
    if not yes and not asked(f"Restore {what} to {device.name} at {device.port}?"):
        raise typer.Exit(FAILED)
    if backup is None:
        _told(where.client.restore(device.id), "restored", format)
        return
    client = where.client
    restored = (
        client.restore_backup(device.id, backup) if of is None else client.restore_backup_of(device.id, of, backup)
    )
    warn(restored.remarks)
    _told(restored.device, "restored", format)


def _told(device: DeviceAnswer, what: str, how: FormatName) -> None:
    ramp = device.ramp
    rows = [(device.id, device.port, what, ramp and ramp.sequence, ramp and ramp.crc, device.on_trial)]
    show(how, device, Rows(("device", "port", "done", "stored so often", "CRC-16", "on trial"), rows))
