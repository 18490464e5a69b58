"""Who does what the command line asks for: a server that runs, or else this program."""

from types import TracebackType
from typing import Self

from stepramp.client import Client
from stepramp.client.servers import Server, named, running
from stepramp.errors import DeviceLost, Rejected, Rejection
from stepramp.http_api.devices_models import DeviceAnswer


class Where:
    """Who is asked: the server that is named, or else the one of this machine that began last, or else this program."""

    def __init__(self, server: str | None = None, *, alone: bool = False, port: str | None = None) -> None:
        """server: its address. alone: ask no server. port: the one that is to be connected to, if any."""
        self._named, self._alone, self._port = server, alone, port
        self._client: Client | None = None
        self.is_alone = False
        """Whether this program does it itself, once the client was asked for."""

    @property
    def client(self) -> Client:
        """The client that asks."""
        if self._client is None:
            self._client = self._made()
        return self._client

    def _made(self) -> Client:
        if self._alone and self._named is not None:
            raise Rejected([Rejection("--server", self._named, "nothing, since --alone is given")])
        if not self._alone:
            told = named(self._named, field="--server")
            if told is not None:
                return Client(server=told)
            if found := running():
                return Client(server=found[0])
        from stepramp.command_line.in_process import HERE, InProcess  # noqa: PLC0415  # loads all of the server

        self.is_alone = True
        return Client(server=Server(HERE), transport=InProcess(self._port))

    def device(self, device_id: str | None, port: str | None, family: str | None) -> DeviceAnswer:
        """Return the device that is meant: by its id, at a port, which is connected to, or else the only one.

        Raises DeviceLost where none is there, Rejected where it isn't clear which.
        """
        if device_id is not None:
            if port is not None:
                raise Rejected([Rejection("--port", port, "nothing, since --device is given")])
            return self.client.device(device_id)
        there = self.client.devices().devices
        if port is not None:
            at_port = [each for each in there if each.port == port and each.state not in ("lost", "connecting")]
            if at_port and family in (None, at_port[0].family):
                return at_port[0]
            return self.client.connect(port, family)
        if len(there) == 1:
            return there[0]
        if not there:
            raise DeviceLost(
                "No device is connected. Name what it is plugged in at: --port; `stepramp ports` lists them."
            )
        listed = ", ".join(f"{each.id} ({each.port})" for each in there)
        raise Rejected([Rejection("--device", None, f"one of {listed}")])

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._client is not None:
            self._client.close()
