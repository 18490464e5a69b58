"""The commands that load nothing of the API: `serve`, and the help of `stop`."""

from typing import Annotated

import typer

from stepramp.command_line import stop as stopping
from stepramp.command_line.completion import completing, family_names
from stepramp.command_line.serving import FIRST_PORT, LOG_LEVELS, LOOPBACK, Options, begin

SERVE_EXAMPLE = "stepramp serve --port 8100 --no-browser"
STOP_EXAMPLE = "stepramp stop"


def add_serve(app: typer.Typer) -> None:
    """Add the server to the program."""
    app.command("serve", epilog=f"Example: {SERVE_EXAMPLE}")(serve)


def add_stop(app: typer.Typer) -> None:
    """Add the stop to the program: for its help. It is carried out before there is a program."""
    app.command("stop", epilog=f"Example: {STOP_EXAMPLE}")(stop)


def serve(
    host: Annotated[
        str,
        typer.Option(
            "--host",
            metavar="ADDRESS",
            help="address to listen on; on another one than this machine's own everybody has to show a "
            "token, which the printed links have",
        ),
    ] = LOOPBACK,
    require_token: Annotated[
        bool,
        typer.Option(
            "--require-token",
            help="ask for a token on this machine's own address, too: for a tunnel or a proxy that others come through",
        ),
    ] = False,
    public_url: Annotated[
        str | None,
        typer.Option(
            "--public-url",
            metavar="URL",
            help="how others reach it, through a proxy with TLS, as https://lab.example: the printed links lead there, "
            "and everybody has to show a token",
        ),
    ] = None,
    certfile: Annotated[
        str | None,
        typer.Option("--certfile", metavar="FILE", help="certificate, to be spoken to over TLS; with --keyfile"),
    ] = None,
    keyfile: Annotated[
        str | None, typer.Option("--keyfile", metavar="FILE", help="the certificate's key, without a password")
    ] = None,
    port: Annotated[
        str, typer.Option("--port", metavar="N", help="port to listen on, the next free one if taken")
    ] = str(FIRST_PORT),
    no_browser: Annotated[bool, typer.Option("--no-browser", help="do not open the page")] = False,
    data_folder: Annotated[
        str | None,
        typer.Option(
            "--data-folder",
            metavar="FOLDER",
            help="where backups of controllers, the library and the note of this server are kept; else "
            "STEPRAMP_DATA's, else the user's own",
        ),
    ] = None,
    log_level: Annotated[
        str,
        typer.Option(
            "--log-level",
            metavar="LEVEL",
            autocompletion=lambda incomplete: [each for each in LOG_LEVELS if each.startswith(incomplete)],
            help=f"how much is told of what goes on, up to each byte: {', '.join(LOG_LEVELS)}",
        ),
    ] = "warning",
    allow_remote_port: Annotated[
        list[str] | None,
        typer.Option(
            "--allow-remote-port",
            metavar="HOST:PORT",
            help="connect also to controllers of this other machine, over rfc2217://, socket:// or moonraker://; may "
            "be repeated",
        ),
    ] = None,
) -> None:
    """Start the server and open its page, until Ctrl+C. It is what `stepramp` without a command does, too."""
    remote = tuple(allow_remote_port or ())
    tls = certfile, keyfile
    begin(Options(host, port, require_token, public_url, *tls, no_browser, data_folder, log_level, remote))


def stop(
    device: Annotated[
        str | None,
        typer.Option("--device", metavar="ID", help="only this device, as `stepramp devices` tells; else all"),
    ] = None,
    axis: Annotated[
        list[int] | None, typer.Option("--axis", metavar="N", help="only this axis, with --device; may be repeated")
    ] = None,
    halt: Annotated[bool, typer.Option("--halt", help="make no further step: a fast motor may slip")] = False,
    server: Annotated[
        str | None,
        typer.Option("--server", metavar="URL", help="only this server; else STEPRAMP_URL's, else all of this machine"),
    ] = None,
    port: Annotated[
        str | None,
        typer.Option("--port", metavar="PORT", help="what is stopped besides, without a server where none has it"),
    ] = None,
    family: Annotated[
        str,
        typer.Option(
            "--family",
            metavar="NAME",
            help="family of the controller at --port",
            autocompletion=completing(family_names),
        ),
    ] = stopping.USUAL_FAMILY,
) -> None:
    """STOP all motors, at once, whatever else hangs; asked for again until it is answered. It is final.

    A word that is not understood stops everything, too. It is no substitute for a switch that cuts the power.
    """
    raise typer.Exit(stopping.carry_out(stopping.Asked(device, axis, halt, server, port, family)))
