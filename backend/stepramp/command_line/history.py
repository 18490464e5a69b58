"""Commands about what became of the library's designs: what was measured, where they went, and all as a file."""

from typing import Annotated, Any, Literal

import typer

from stepramp.client.design_calls import MOST_FILE_BYTES
from stepramp.command_line.commands import command
from stepramp.command_line.designs import GROUP, Kept, Number, Output, write_json
from stepramp.command_line.files import bytes_of, document_of, write
from stepramp.command_line.output import Format, Rows, show, tell
from stepramp.command_line.where import Where
from stepramp.errors import NotFound, Rejected, Rejection, shown
from stepramp.http_api.history_models import PushedToAnswer

MOST_LIBRARY_BYTES = 2**31
"""Size of the largest library that a server takes [bytes]."""
MOST_TOLD_VALUES = 4_000_000
"""Of a trace of the most steps, 500,000."""
MOST_KEPT_STEPS = 5000
"""Of a trace: four values each, and the most that a document may have are twice as many. The page keeps as many."""
Kind = Annotated[
    Literal["trace", "capture", "stall_map"], typer.Option("--kind", help="what it is: trace, capture or stall_map")
]


def add(app: typer.Typer) -> None:
    """Add the commands to their group."""
    for name, function, example in (
        ("keep", keep, "stepramp designs keep ID trace.json --kind trace --note 'with the new drive'"),
        ("records", records, "stepramp designs records ID"),
        ("record", record, "stepramp designs record ID RECORD --output kept.json"),
        ("devices", devices, "stepramp designs devices"),
        ("pushes", pushes, "stepramp designs pushes --design ID"),
        ("pushed", pushed, "stepramp designs pushed PUSH --output pushed.json"),
        ("export", export, "stepramp designs export --output library.jsonl"),
        ("import", add_file, "stepramp designs import library.jsonl"),
    ):
        command(app, name, example=example, group=GROUP)(function)


def keep(
    where: Where,
    design_id: Kept,
    file: Annotated[str, typer.Argument(metavar="FILE", help="JSON as it was told, - for standard input")],
    kind: Kind,
    revision: Number = None,
    note: Annotated[str, typer.Option("--note", metavar="TEXT", help="what is to be known of it")] = "",
    format: Format = "table",
) -> None:
    """Keep what `trace`, `capture` or `map` has told as JSON with the revision that it is of."""
    allowed = "a file with what was told as JSON"
    document = document_of(file, "FILE", allowed, most_bytes=MOST_FILE_BYTES, most_values=MOST_TOLD_VALUES)
    if not isinstance(document, dict):
        raise Rejected([Rejection("FILE", file, "a file with a JSON object")])
    if kind == "trace":
        document = _thinned(document)
    number = where.client.kept_design(design_id).revisions if revision is None else revision
    kept = where.client.keep_record(design_id, number, kind, document, note=note)
    show(format, kept, Rows(("record", "kind", "revision"), [(kept.id, kept.kind, kept.revision)]))


def records(where: Where, design_id: Kept, format: Format = "table") -> None:
    """List what was kept with a design, the newest first."""
    answer = where.client.records(design_id)
    rows = [(each.id, each.kind, each.revision, each.note, each.kept_at) for each in answer.records]
    show(format, answer, Rows(("record", "kind", "revision", "note", "kept at"), rows))


def record(
    where: Where,
    design_id: Kept,
    record_id: Annotated[str, typer.Argument(metavar="RECORD", help="what `stepramp designs records` calls it")],
    file: Output = "-",
) -> None:
    """Write what was kept with a design, as it was told."""
    write_json(file, where.client.record(design_id, record_id).document)


def devices(where: Where, format: Format = "table") -> None:
    """List the controllers that were ever connected, that seen last first."""
    answer = where.client.seen_devices()
    rows = [(each.id, each.name, each.family, each.port, each.last_seen_at, each.pushes) for each in answer.devices]
    show(format, answer, Rows(("device", "name", "family", "port", "seen at", "pushes"), rows))


def pushes(
    where: Where,
    design_id: Annotated[
        str | None, typer.Option("--design", metavar="ID", help="of this design of the library only")
    ] = None,
    device_id: Annotated[
        str | None, typer.Option("--device", metavar="ID", help="to what `stepramp designs devices` calls so only")
    ] = None,
    first: Annotated[int, typer.Option("--first", help="so many are left out, the newest ones")] = 0,
    most: Annotated[int | None, typer.Option("--most", help="so many are told")] = None,
    format: Format = "table",
) -> None:
    """List what was pushed, the newest first: when, by whom, which revision, and whether it was read back as sent."""
    if design_id is not None:
        where.client.kept_design(design_id)  # One that there isn't was never pushed either, but who asks means another.
    if device_id is not None and device_id not in {each.id for each in where.client.seen_devices().devices}:
        raise NotFound(f"There is no device {shown(device_id)} in the library: `stepramp designs devices` lists them.")
    answer = where.client.search_pushes(design_id=design_id, device_id=device_id, first=first, most=most)
    columns = ("push", "pushed at", "device", "by", "designs", "came of it", "backup")
    rows = [
        (each.id, each.pushed_at, each.device, each.client, _designs(each), _outcome(each), each.backup)
        for each in answer.pushes
    ]
    show(format, answer, Rows(columns, rows, f"{len(rows):,} of {answer.count:,} pushes"))


def pushed(
    where: Where,
    push_id: Annotated[str, typer.Argument(metavar="PUSH", help="what `stepramp designs pushes` calls it")],
    axis: Annotated[int | None, typer.Option("--axis", help="which axis, from 0; needed where it was several")] = None,
    file: Output = "-",
) -> None:
    """Write the document of a design as it was pushed, and tell what came of the push."""
    answer = where.client.pushed(push_id)
    given = {each.axis: each.design for each in answer.designs}
    if axis is None and len(given) == 1:
        [axis] = given
    if not given:
        raise NotFound("The library has no design of this push.")
    if axis is None or axis not in given:
        raise Rejected([Rejection("--axis", axis, f"one of {', '.join(map(str, sorted(given)))}")])
    tell(f"{answer.pushed_at} to {answer.device}: {_outcome(answer)}")
    write_json(file, given[axis])


def export(where: Where, file: Output = "-") -> None:
    """Write the whole library as one file: designs with all revisions and records, devices, and pushes."""
    content = where.client.library_file()
    write(file, content, "--output")
    if len(content) > MOST_LIBRARY_BYTES:
        tell(
            f"warning: it has {len(content):,} bytes, and only {MOST_LIBRARY_BYTES:,} can be imported: "
            "copy the database itself, too"
        )


def add_file(
    where: Where,
    file: Annotated[
        str, typer.Argument(metavar="FILE", help="what `stepramp designs export` wrote, - for standard input")
    ],
    format: Format = "table",
) -> None:
    """Add what such a file has and the library hasn't: all of it, or nothing. Nothing is overwritten."""
    answer = where.client.add_library_file(bytes_of(file, "FILE", MOST_LIBRARY_BYTES))
    counts = [(name.replace("_", " "), value) for name, value in answer.model_dump(exclude={"copies"}).items()]
    copies = [("added beside another", name) for name in answer.copies]
    show(format, answer, Rows(("of the file", "added"), [*counts, *copies]))


def _thinned(trace: dict[str, Any]) -> dict[str, Any]:
    """Return a trace of no more steps than are kept, the first and the last of them; who keeps it is told."""
    steps = trace.get("step")
    if not isinstance(steps, list) or len(steps) <= MOST_KEPT_STEPS:
        return trace
    tell(f"the trace has {len(steps):,} steps: {MOST_KEPT_STEPS:,} of them, evenly apart, are kept")
    places = [round(n * (len(steps) - 1) / (MOST_KEPT_STEPS - 1)) for n in range(MOST_KEPT_STEPS)]
    is_column = {name: isinstance(value, list) and len(value) == len(steps) for name, value in trace.items()}
    return {name: [value[place] for place in places] if is_column[name] else value for name, value in trace.items()}


def _designs(push: PushedToAnswer) -> str:
    """Return the designs of a push, with the newest of the revisions that are the same."""
    told = []
    for each in push.axes:
        known = f" (revision {each.revisions[0].number:,} of {each.revisions[0].design_id})" if each.revisions else ""
        told.append(f"axis {each.axis}: {each.name or 'unnamed'}{known}")
    return ", ".join(told)


def _outcome(push: PushedToAnswer) -> str:
    if push.trouble is not None:
        return f"failed: {push.trouble}"
    return "read back as sent" if push.verified else "NOT read back as sent"
