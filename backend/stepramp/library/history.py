"""What was pushed to which device and read back, and the devices that were seen. Nothing of it is ever deleted."""

import json
import uuid
from collections.abc import Mapping
from dataclasses import dataclass

from sqlalchemy import Connection, RowMapping, Select, func, insert, select, update

from stepramp.design import Design
from stepramp.errors import NotFound, shown
from stepramp.library.database import Database
from stepramp.library.schema import DESIGNS, DEVICES, PUSHED_AXES, PUSHES, REVISIONS
from stepramp.library.texts import ID, as_text, content_of, hash_of, now, without_nul

MOST_REVISIONS = 20
"""So many revisions that are the same as what was pushed are told."""


@dataclass(frozen=True)
class Device:
    """A device as it was seen. identity: what tells it apart, as its USB serial number; else its port."""

    family: str
    identity: str
    name: str
    port: str

    @property
    def id(self) -> str:
        """What the library calls it: the same for the same device, in any library."""
        return hash_of(as_text([self.family, self.identity]))[:32]


@dataclass(frozen=True)
class SeenDevice:
    """A device with when it was seen first and last, and how many pushes there were."""

    id: str
    family: str
    identity: str
    name: str
    port: str
    first_seen_at: str
    last_seen_at: str
    pushes: int


@dataclass(frozen=True)
class Push:
    """A push that has just ended. client: who asked for it, on a shared server.

    report: what was sent and read back; trouble: why there is none, in words. backup: the last one taken before.
    """

    device: Device
    designs: Mapping[int, Design]
    """By the axis of each."""
    mode: str
    client: str | None = None
    report: object = None
    trouble: str | None = None
    backup: str | None = None


@dataclass(frozen=True)
class KeptRevision:
    """A revision that has a design."""

    design_id: str
    name: str
    number: int


@dataclass(frozen=True)
class PushedAxis:
    """The design that an axis was given, and the revisions of the library that are the same."""

    axis: int
    name: str
    content_hash: str
    revisions: list[KeptRevision]


@dataclass(frozen=True)
class Pushed:
    """A push of the history; its report and its designs are asked for by themselves."""

    id: str
    device_id: str
    device: str
    pushed_at: str
    client: str | None
    mode: str
    trouble: str | None
    verified: bool | None
    backup: str | None
    axes: list[PushedAxis]


class History:
    """The history of one database. For any thread."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def note_device(self, device: Device) -> None:
        """Note that a device is there."""
        with self._database.writing() as connection:
            _see(connection, device)

    def note_push(self, push: Push) -> str:
        """Note a push; return what it is called."""
        made = uuid.uuid4().hex
        row = {
            "id": made,
            "device_id": push.device.id,
            "pushed_at": now(),
            "client": push.client,
            "mode": push.mode,
            "trouble": None if push.trouble is None else without_nul(push.trouble),
            "report": None if push.report is None else as_text(push.report),
            "backup": push.backup,
        }
        axes = [_axis_row(made, axis, design) for axis, design in push.designs.items()]
        with self._database.writing() as connection:
            _see(connection, push.device)
            connection.execute(insert(PUSHES).values(row))
            connection.execute(insert(PUSHED_AXES), axes)
        return made

    def devices(self) -> list[SeenDevice]:
        """Return all devices, that seen last first."""
        count = select(func.count()).select_from(PUSHES).where(PUSHES.c.device_id == DEVICES.c.id).scalar_subquery()
        chosen = select(DEVICES, count.label("pushes")).order_by(DEVICES.c.last_seen_at.desc(), DEVICES.c.id)
        with self._database.reading() as connection:
            return [SeenDevice(**row) for row in connection.execute(chosen).mappings()]

    def pushes(
        self, device_id: str | None = None, design_id: str | None = None, first: int = 0, most: int = 100
    ) -> tuple[int, list[Pushed]]:
        """Return how many there are, and some, the newest first.

        device_id: to this device only. design_id: of any revision of this design only.
        """
        chosen = _PUSHES
        if device_id is not None:
            chosen = chosen.where(PUSHES.c.device_id == device_id)
        if design_id is not None:
            hashes = select(REVISIONS.c.content_hash).where(REVISIONS.c.design_id == design_id)
            is_of = select(PUSHED_AXES).where(PUSHED_AXES.c.push_id == PUSHES.c.id)
            chosen = chosen.where(is_of.where(PUSHED_AXES.c.content_hash.in_(hashes)).exists())
        newest = chosen.order_by(PUSHES.c.pushed_at.desc(), PUSHES.c.id).offset(first).limit(most)
        with self._database.reading() as connection:
            count = connection.execute(select(func.count()).select_from(chosen.subquery())).scalar_one()
            return count, [_pushed(connection, row) for row in connection.execute(newest).mappings().all()]

    def push(self, push_id: str) -> tuple[Pushed, object, dict[int, object]]:
        """Return a push, its report, and the design of each axis; NotFound when there is none."""
        designs = select(PUSHED_AXES.c.axis, PUSHED_AXES.c.content).where(PUSHED_AXES.c.push_id == push_id)
        with self._database.reading() as connection:
            row = connection.execute(_PUSHES.where(PUSHES.c.id == push_id)).mappings().one_or_none()
            if row is None or not ID.fullmatch(push_id):
                raise NotFound(f"There is no push {shown(push_id)} in the library.")
            contents = {axis: json.loads(content) for axis, content in connection.execute(designs)}
            return _pushed(connection, row), _report(row), contents


_PUSHES: Select[tuple[object, ...]] = select(
    *(PUSHES.c[name] for name in ("id", "device_id", "pushed_at", "client", "mode", "trouble", "report", "backup")),
    DEVICES.c.name.label("device"),
).join(DEVICES)


def _see(connection: Connection, device: Device) -> None:
    seen = {"name": without_nul(device.name), "port": without_nul(device.port), "last_seen_at": now()}
    known = update(DEVICES).where(DEVICES.c.id == device.id)
    if connection.execute(known.values(seen)).rowcount == 0:
        told = {"id": device.id, "family": device.family, "identity": without_nul(device.identity)}
        connection.execute(insert(DEVICES).values(**told, **seen, first_seen_at=seen["last_seen_at"]))


def _axis_row(push_id: str, axis: int, design: Design) -> dict[str, object]:
    content = content_of(design)
    return {
        "push_id": push_id,
        "axis": axis,
        "name": without_nul(design.name),
        "content": content,
        "content_hash": hash_of(content),
    }


def _pushed(connection: Connection, row: RowMapping) -> Pushed:
    columns = (PUSHED_AXES.c.axis, PUSHED_AXES.c.name, PUSHED_AXES.c.content_hash)
    chosen = select(*columns).where(PUSHED_AXES.c.push_id == row["id"]).order_by(PUSHED_AXES.c.axis)
    axes = [
        PushedAxis(axis, name, content_hash, _revisions(connection, content_hash))
        for axis, name, content_hash in connection.execute(chosen)
    ]
    told = {name: value for name, value in row.items() if name != "report"}
    report = _report(row)
    return Pushed(**told, verified=report.get("verified") is True if isinstance(report, dict) else None, axes=axes)


def _report(row: RowMapping) -> object:
    return None if row["report"] is None else json.loads(row["report"])


def _revisions(connection: Connection, content_hash: str) -> list[KeptRevision]:
    columns = (REVISIONS.c.design_id, DESIGNS.c.name, REVISIONS.c.number)
    chosen = select(*columns).join(DESIGNS).where(REVISIONS.c.content_hash == content_hash)
    newest = connection.execute(chosen.order_by(REVISIONS.c.saved_at.desc()).limit(MOST_REVISIONS))
    return [KeptRevision(*each) for each in newest]
