"""Commands about the library of designs."""

import json
from typing import Annotated

import typer

from stepramp.command_line.commands import command
from stepramp.command_line.files import DesignFile, design_of, write
from stepramp.command_line.output import Format, FormatName, Rows, figure, show
from stepramp.command_line.visible import visible_json
from stepramp.command_line.where import Where
from stepramp.errors import Rejected, Rejection
from stepramp.http_api.library_models import KeptAnswer

GROUP = "designs"
Kept = Annotated[str, typer.Argument(metavar="ID", help="what `stepramp designs list` calls it")]
Number = Annotated[int | None, typer.Option("--revision", help="which revision, from 1; else the newest")]
Note = Annotated[str, typer.Option("--note", metavar="TEXT", help="what is to be known of this revision")]
Output = Annotated[str, typer.Option("--output", metavar="FILE", help="file to write, - for standard output")]
Tags = Annotated[list[str] | None, typer.Option("--tag", metavar="TAG", help="may be repeated")]


def add(app: typer.Typer) -> None:
    """Add the commands to their group."""
    for name, function, example in (
        ("list", listed, "stepramp designs list --tag gauge"),
        ("show", shown, "stepramp designs show ID"),
        ("save", saved, "stepramp designs save design.json --name Stage --tag gauge"),
        ("revisions", revisions, "stepramp designs revisions ID"),
        ("diff", diff, "stepramp designs diff ID 1 2"),
        ("duplicate", duplicate, "stepramp designs duplicate ID --name Copy"),
        ("describe", describe, "stepramp designs describe ID --name Stage --notes 'quieter at 800 steps/s'"),
    ):
        command(app, name, example=example, group=GROUP)(function)


def listed(
    where: Where,
    text: Annotated[str, typer.Argument(metavar="[WORDS]", help="words of name, notes and tags, all of them")] = "",
    tags: Tags = None,
    most: Annotated[int | None, typer.Option("--most", help="so many are told")] = None,
    format: Format = "table",
) -> None:
    """List the designs of the library, those changed last first."""
    answer = where.client.search_designs(text, tags or [], most=most)
    show(format, answer, _kept(answer.designs, f"{len(answer.designs):,} of {answer.count:,} designs"))


def shown(
    where: Where,
    design_id: Kept,
    revision: Number = None,
    file: Output = "-",
) -> None:
    """Write the document of a design, as it was saved."""
    number = where.client.kept_design(design_id).revisions if revision is None else revision
    document = where.client.revision(design_id, number).design
    write_json(file, document)


def saved(
    where: Where,
    design: DesignFile,
    to: Annotated[
        str | None,
        typer.Option("--to", metavar="ID", help="save it as another revision of this design; else a new one"),
    ] = None,
    name: Annotated[
        str | None, typer.Option("--name", metavar="TEXT", help="of a new one; else the design's own")
    ] = None,
    notes: Annotated[str | None, typer.Option("--notes", metavar="TEXT", help="of a new one")] = None,
    tags: Annotated[
        list[str] | None, typer.Option("--tag", metavar="TAG", help="of a new one; may be repeated")
    ] = None,
    note: Note = "",
    format: Format = "table",
) -> None:
    """Save a design in the library."""
    for option, value in (("--name", name), ("--notes", notes), ("--tag", tags)):
        if to is not None and value is not None:
            allowed = "nothing with --to: `stepramp designs describe` changes what a design is called"
            raise Rejected([Rejection(option, value, allowed)])
    planned = design_of(design)
    if to is None:
        kept = where.client.add_design(planned, name=name, notes=notes or "", tags=tags or [], note=note)
    else:
        kept = where.client.save_revision(to, where.client.kept_design(to).version, planned, note=note)
    _tell_kept(kept, format)


def revisions(where: Where, design_id: Kept, format: Format = "table") -> None:
    """List the revisions of a design, the newest first."""
    answer = where.client.kept_design(design_id)
    rows = [(each.number, each.saved_at, each.note, each.content_hash[:12]) for each in answer.history]
    show(format, answer, Rows(("revision", "saved at", "note", "SHA-256"), rows, answer.name))


def diff(
    where: Where,
    design_id: Kept,
    number: Annotated[int, typer.Argument(metavar="REVISION", help="from 1")],
    other: Annotated[int, typer.Argument(metavar="OTHER", help="the one that it is compared with")],
    format: Format = "table",
) -> None:
    """Tell the fields that two revisions differ in."""
    answer = where.client.differences(design_id, number, other)
    rows = [(each.field, _told(each.before), _told(each.after)) for each in answer.differences]
    show(format, answer, Rows(("field", f"revision {number}", f"revision {other}"), rows))


def duplicate(
    where: Where,
    design_id: Kept,
    name: Annotated[str, typer.Option("--name", metavar="TEXT", help="what the copy is called")],
    format: Format = "table",
) -> None:
    """Keep a copy of a design's newest revision as a design of its own."""
    _refuse_nameless(name)
    _tell_kept(where.client.duplicate_design(design_id, name), format)


def describe(
    where: Where,
    design_id: Kept,
    name: Annotated[str | None, typer.Option("--name", metavar="TEXT", help="another name")] = None,
    notes: Annotated[str | None, typer.Option("--notes", metavar="TEXT", help="other notes")] = None,
    tags: Tags = None,
    format: Format = "table",
) -> None:
    """Name a design anew; what isn't given stays."""
    if name is None and notes is None and tags is None:
        raise Rejected([Rejection("--name", None, "at least one of --name, --notes and --tag")])
    _refuse_nameless(name)
    before = where.client.kept_design(design_id)
    kept = where.client.describe_design(
        design_id,
        before.version,
        before.name if name is None else name,
        notes=before.notes if notes is None else notes,
        tags=before.tags if tags is None else tags,
    )
    _tell_kept(kept, format)


def write_json(file: str, document: object) -> None:
    """Write a document as it was kept."""
    text = visible_json(json.dumps(document, ensure_ascii=False, indent=2))
    write(file, f"{text}\n".encode(), "--output")


def _refuse_nameless(name: str | None) -> None:
    if name is not None and not name.strip():
        raise Rejected([Rejection("--name", name, "a text that isn't empty")])


def _tell_kept(kept: KeptAnswer, how: FormatName) -> None:
    show(how, kept, _kept([kept], ""))


def _kept(designs: list[KeptAnswer], title: str) -> Rows:
    rows = [(each.id, each.name, ", ".join(each.tags), each.revisions, each.saved_at) for each in designs]
    return Rows(("id", "name", "tags", "revisions", "saved at"), rows, title)


def _told(value: object) -> str:
    return json.dumps(value, ensure_ascii=False) if isinstance(value, list | dict) else figure(value)
