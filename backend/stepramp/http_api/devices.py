"""Routes over the attached controllers: connecting, ramps, and the WebSocket that tells how they fare."""

import asyncio
from collections.abc import AsyncGenerator, Coroutine
from contextlib import aclosing, suppress

from fastapi import APIRouter, WebSocket

from stepramp.devices.registry import Devices
from stepramp.errors import Refused
from stepramp.http_api import backups, jog, motion, settings, stopping, surroundings
from stepramp.http_api.answered import UNREAD_S
from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.device_registry import Acting, ClientName, Keeper, Page, Registry, page_at
from stepramp.http_api.devices_models import (
    ConnectPayload,
    DeviceAnswer,
    DevicesAnswer,
    DisconnectedAnswer,
    FoundAnswer,
    KeptAnswer,
    PortPayload,
    PortsAnswer,
    PreviewAnswer,
    PushDesigns,
    PushedAnswer,
    PushPayload,
)
from stepramp.http_api.error_items import ErrorList
from stepramp.http_api.lanes import ACTING, CONNECTING, PLANNING, PUSHING
from stepramp.http_api.news import News
from stepramp.http_api.sign_in import client_of
from stepramp.http_api.sockets import accept, received, send, send_at_last, served
from stepramp.http_api.stop_messages import MOST_AT_A_TIME, PendingAnswer, PendingAnswers, answered

router = APIRouter(
    tags=["devices"],
    route_class=JsonRoute,
    responses={
        404: {"model": ErrorList, "description": "No such device"},
        409: {"model": ErrorList, "description": "Not now: the motor moves, or the controller has no ramp"},
        502: {"model": ErrorList, "description": "The device does not answer, or its port is gone"},
    },
)
router.include_router(stopping.router)
router.include_router(motion.router)
router.include_router(jog.router)
router.include_router(settings.router)
router.include_router(surroundings.router)
router.include_router(backups.router)


@router.get("/ports")
@ACTING.serves
def ports(devices: Registry) -> PortsAnswer:
    """Return the ports of this machine, those of others that may be reached, the virtual one last, and all families.

    Of other machines it lists those that the server was started with, by `--allow-remote-port host:port`.
    """
    found = [{**vars(each), "families": devices.families_at(each.port)} for each in devices.ports()]
    return PortsAnswer.model_validate({"ports": found, "families": list(devices.families.values())})


@router.post("/ports/find")
@CONNECTING.serves
def find_family(request: PortPayload, devices: Registry) -> FoundAnswer:
    """Listen for up to 5 s to what the controller at a port says of itself, and return which family it names.

    Opening the port starts most boards anew; nothing is sent to it. Many say nothing before they are asked: StepRamp's
    own, Tics, TMCL modules, and boards that go on when a port is opened.
    """
    return FoundAnswer.model_validate(devices.find_family(request.port))


@router.get("/devices")
async def all_devices(devices: Registry) -> DevicesAnswer:
    """Return the devices that are connected, or were until they were lost."""
    return DevicesAnswer.model_validate({"devices": devices.views()})


@router.post("/devices")
@CONNECTING.serves
def connect(request: ConnectPayload, devices: Registry, page: Page, keeper: Keeper) -> DeviceAnswer:
    """Connect to a port, which takes up to 5 s, and return its device. Nothing moves.

    A device that was lost is connected again by itself, as one of the family that it was connected as.
    """
    device = devices.connect(request.port, request.family)
    keeper.note_device(device)
    with suppress(Refused):  # It was connected already, and another page is in control: it stays so.
        devices.acting(device.view.id, page)
    return DeviceAnswer.model_validate(device.view)


@router.get("/devices/{device_id}")
async def one_device(device_id: str, devices: Registry) -> DeviceAnswer:
    """Return a device as it is now."""
    return DeviceAnswer.model_validate(devices.get(device_id).view)


@router.delete("/devices/{device_id}")
@CONNECTING.serves
def disconnect(device: Acting, devices: Registry) -> DisconnectedAnswer:
    """Let go of a device; refused while a motor of it moves."""
    devices.disconnect(device.view.id)
    return DisconnectedAnswer()


@router.post("/devices/{device_id}/control")
async def take_over(device_id: str, devices: Registry, page: Page) -> DeviceAnswer:
    """Put the page that asks in control, whichever was before. Nothing moves or stops by that but another's jog."""
    if page is None:
        raise Refused("Only a page can be in control: say which in the header X-StepRamp-Page.")
    return DeviceAnswer.model_validate(devices.take_over(device_id, page).view)


@router.post("/devices/{device_id}/push")
@PUSHING.serves
def push(request: PushPayload, device: Acting, keeper: Keeper, client: ClientName) -> PushedAnswer:
    """Have the controller use designs' ramps, stored or on trial, and read them back; refused while a motor moves.

    What came of it is kept in the library: `POST /library/pushes/search`.
    """
    with keeper.noting(device, request.designs, request.first_axis, request.mode, client) as pushing:
        report = device.push(request.designs, request.first_axis, request.mode, PLANNING.wait_for)
        pushing.report = PushedAnswer.of(report, device.view.heard_s)
        return pushing.report


@router.post("/devices/{device_id}/push/preview")
@PLANNING.serves
def preview_push(device_id: str, request: PushDesigns, devices: Registry) -> PreviewAnswer:
    """Return what a push would change of the ramps in use; nothing is sent."""
    preview = devices.get(device_id).preview_push(request.designs, request.first_axis)
    return PreviewAnswer.model_validate(preview)


@router.post("/devices/{device_id}/keep")
@ACTING.serves
def keep(device: Acting) -> KeptAnswer:
    """Store the ramps and settings that are in use, on trial or not."""
    remarks = device.keep()
    return KeptAnswer(**dict(DeviceAnswer.model_validate(device.view)), remarks=list(remarks))


@router.post("/devices/{device_id}/roll_back")
@ACTING.serves
def roll_back(device: Acting) -> DeviceAnswer:
    """Drop the ramps and settings that are on trial: the stored ones are used again."""
    device.roll_back()
    return DeviceAnswer.model_validate(device.view)


@router.post("/devices/{device_id}/restore")
@ACTING.serves
def restore(device: Acting) -> DeviceAnswer:
    """Bring back the ramps and settings that were stored before the present ones; a second time brings those back."""
    device.restore()
    return DeviceAnswer.model_validate(device.view)


@router.websocket("/devices/events")
async def events(socket: WebSocket, devices: Registry, page: str | None = None) -> None:
    """Send all devices at once and after each change, at most 50 times a second; the newest state wins.

    They are sent every second, too, when nothing changes: who hears nothing for longer knows old states only.

    page: what the page that listens calls itself; it can be in control of devices as long as it does. Who listens can
    stop, too: `{"do": "stop"}` and `{"do": "halt", "device": "1"}` are answered once that is granted, with `did`.
    """
    news: News = socket.app.state.news
    answers = PendingAnswers()
    async with served(socket):
        await accept(socket)
        client = client_of(socket.scope)
        with devices.present(page_at(socket, page), None if client is None else client.place):
            try:
                await _until_one_ends(
                    _tell(socket, news.editions()), _answer(socket, answers.given()), _hear(socket, devices, answers)
                )
            finally:
                answers.give_up()


async def _tell(socket: WebSocket, texts: AsyncGenerator[str, None]) -> None:
    async with aclosing(texts):
        async for text in texts:
            await send(socket, text)


async def _answer(socket: WebSocket, answers: AsyncGenerator[PendingAnswer, None]) -> None:
    async with aclosing(answers):
        async for answer in answers:
            try:
                await send_at_last(socket, answer.made)
            finally:
                answer.give_up()


async def _hear(socket: WebSocket, devices: Devices, answers: PendingAnswers) -> None:
    """Stop whenever that is asked for, until the other end has gone."""
    stopping: set[asyncio.Task[None]] = set()
    room = asyncio.Semaphore(MOST_AT_A_TIME)

    async def stop(message: str | bytes) -> None:
        try:
            answer = await answered(message, devices)
            asyncio.get_running_loop().call_later(UNREAD_S, answer.give_up)
            answers.add(answer)
        finally:
            room.release()

    while True:
        # Before a message is taken: one that isn't taken is still there when the other end goes.
        await room.acquire()
        message = await received(socket)
        # In a task of its own: a halt must not wait until the stop before it is granted.
        task = asyncio.create_task(stop(message))
        stopping.add(task)
        task.add_done_callback(stopping.discard)


async def _until_one_ends(*works: Coroutine[None, None, None]) -> None:
    """Do several things at the same time until one of them ends; raise what it raised."""
    tasks = [asyncio.create_task(work) for work in works]
    try:
        ended, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        for task in ended:
            task.result()
    finally:
        for task in tasks:
            task.cancel()
