"""A server that other machines may use: who is known, what a role may do, the share of a client, and the log."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from starlette.testclient import TestClient
from starlette.websockets import WebSocketDisconnect

from designs import document
from stepramp.http_api import client_limits
from stepramp.http_api.access import COOKIE, MOST_SESSIONS, Access, Role
from stepramp.http_api.app import create_app
from stepramp.http_api.turned_away import EACH_S, MOST_LINES, TurnedAway
from waiting import until

HOST = "bench.example:8000"
BASE = f"http://{HOST}"
TOKENS = {Role.VIEW: "a-token-of-those-who-look-on", Role.OPERATE: "a-token-of-those-who-operate"}
OPERATES = {"authorization": f"Bearer {TOKENS[Role.OPERATE]}"}
LOOKS_ON = {"authorization": f"Bearer {TOKENS[Role.VIEW]}"}
DEVICES = "/api/v1/devices"
EVENTS = f"{DEVICES}/events"
A_PAGE = {"accept": "text/html,*/*"}
COMPUTES = {
    "/api/v1/capture",
    "/api/v1/curves",
    "/api/v1/errors",
    "/api/v1/export/{format}",
    "/api/v1/families/{name}/ramp",
    "/api/v1/import",
    "/api/v1/jobs/{job_id}",
    "/api/v1/machine/{machine}",
    "/api/v1/machine/{machine}/ramp",
    "/api/v1/motor/fastest",
    "/api/v1/motor/gauge_table",
    "/api/v1/motor/map",
    "/api/v1/motor/simulate",
    "/api/v1/motor/torque",
    "/api/v1/profile",
    "/api/v1/report",
    "/api/v1/retarget",
    "/api/v1/schedule",
    "/api/v1/table/check",
    "/api/v1/table/fit",
    "/api/v1/table/fit/curve",
    "/api/v1/table/play",
}
"""What isn't reading, and yet changes nothing for anybody else."""


@pytest.fixture
def server(tmp_path: Path) -> Iterator[TestClient]:
    app = create_app(data=tmp_path, access=Access(TOKENS))
    with TestClient(app, base_url=BASE, raise_server_exceptions=False, follow_redirects=False) as client:
        yield client


def signed_in(server: TestClient, role: Role) -> None:
    assert server.get("/", params={"token": TOKENS[role]}, headers=A_PAGE).status_code == 303


def message(response: Any) -> str:
    [error] = response.json()["errors"]
    return str(error["message"])


def test_who_is_turned_away_is_in_the_log_once_a_minute(caplog: pytest.LogCaptureFixture) -> None:
    times_s = iter((0, 1, 2, 59, 61))
    away = TurnedAway(lambda: next(times_s))
    asked = {"type": "http", "method": "POST", "path": "/api/v1/devices\n", "client": ("192.0.2.7", 5)}
    for place in (7, 7, 8, 7, 7):
        away.note({**asked, "client": (f"192.0.2.{place}", 5)})
    assert [each.getMessage() for each in caplog.records] == [
        "192.0.2.7 asked without a token of this server: 'POST /api/v1/devices\\n'.",
        "192.0.2.8 asked without a token of this server: 'POST /api/v1/devices\\n'.",
        "192.0.2.7 asked without a token of this server: 'POST /api/v1/devices\\n', "
        "and 2 times more since it was told last.",
    ]


def test_nobody_fills_the_log_by_having_many_addresses(caplog: pytest.LogCaptureFixture) -> None:
    now_s = 0.0
    away = TurnedAway(lambda: now_s)
    asked = {"type": "http", "method": "GET", "path": DEVICES}
    for number in range(3000):
        away.note({**asked, "client": (f"2001:db8::{number:x}", 1)})
    assert len(caplog.records) == 1, "a network of IPv6 is one place"
    for number in range(3000):
        away.note({**asked, "client": (f"2001:db8:{number:x}::1", 1)})
        away.note({**asked, "client": (f"::ffff:192.0.{number // 250}.{number % 250}", 1)})
    assert len(caplog.records) == MOST_LINES
    now_s = EACH_S
    caplog.clear()
    away.note({**asked, "client": ("198.51.100.7", 1)})
    told = [each.getMessage() for each in caplog.records]
    # 3,000 of each kind, of which one network was told of before.
    assert told[0] == "Others asked 5,900 times without a token: more than 100 lines a minute are not written."
    assert told[1].startswith("198.51.100.7 asked")


def test_a_token_that_counts_for_nothing_is_in_the_log_without_it(
    server: TestClient, caplog: pytest.LogCaptureFixture
) -> None:
    server.get("/", headers=A_PAGE)
    assert caplog.records == []  # Who has yet to type it in.
    server.get("/", params={"token": "guessed"}, headers=A_PAGE)
    server.post(f"{DEVICES}/stop")
    [told] = [each.getMessage() for each in caplog.records]
    assert "'GET /'" in told


def test_nobody_is_served_unknown(server: TestClient) -> None:
    for path in ("/api/v1/access", "/api/v1/devices", "/assets/plotly/plotly.min.js", "/docs", "/nothing"):
        refused = server.get(path)
        assert (refused.status_code, refused.headers["www-authenticate"]) == (401, 'Bearer realm="StepRamp"'), path
        assert "Authorization: Bearer" in message(refused)
    assert server.post(f"{DEVICES}/stop").status_code == 401
    for wrong in ("Bearer", "Bearer nonsense", f"Basic {TOKENS[Role.OPERATE]}", f"Bearer {TOKENS[Role.OPERATE]}x", "é"):
        assert server.get("/api/v1/access", headers={"authorization": wrong.encode()}).status_code == 401, wrong
    assert server.get("/api/v1/health").json()["status"] == "ok"
    for socket in (EVENTS, "/api/v1/curves/socket", f"{DEVICES}/1/jog"):
        with pytest.raises(WebSocketDisconnect), server.websocket_connect(socket, headers={"host": HOST}):
            pass


def test_a_browser_is_shown_the_way_in_and_the_token_leaves_its_address(server: TestClient) -> None:
    form = server.get("/", headers=A_PAGE)
    assert (form.status_code, form.headers["cache-control"]) == (401, "no-store")
    assert "Token <input" in form.text
    wrong = server.get("/", params={"token": "<b>wrong"}, headers=A_PAGE)
    assert (wrong.status_code, "no token of this server" in wrong.text, "<b>" in wrong.text) == (401, True, False)
    shown = server.get("/?a=1&token=" + TOKENS[Role.OPERATE] + "&b=", headers=A_PAGE)
    assert (shown.status_code, shown.headers["location"]) == (303, "/?a=1&b=")
    cookie = shown.headers["set-cookie"]
    assert "HttpOnly" in cookie
    assert "samesite=lax" in cookie.lower()
    assert TOKENS[Role.OPERATE] not in cookie
    assert server.get("/", headers=A_PAGE).status_code == 200
    assert server.get("/api/v1/access").json() == {"role": "operate", "is_shared": True, "place": "testclient"}


def test_a_link_leads_nowhere_else(server: TestClient) -> None:
    for path in ("//evil.example/", "///evil.example", "/%5Cevil.example", "/\\\\evil.example"):
        shown = server.get(f"{BASE}{path}?token={TOKENS[Role.VIEW]}")
        location = shown.headers["location"]
        assert location.startswith("/"), path
        assert not location.startswith(("//", "/\\")), path


def test_a_link_of_a_page_elsewhere_is_not_taken(server: TestClient) -> None:
    foreign = {"origin": "http://evil.example", **A_PAGE}
    assert server.get("/", params={"token": TOKENS[Role.VIEW]}, headers=foreign).status_code == 403
    assert server.get("/api/v1/access", params={"token": TOKENS[Role.VIEW]}).status_code == 401


def test_over_tls_the_cookie_goes_over_tls_only(tmp_path: Path) -> None:
    app = create_app(data=tmp_path, access=Access(TOKENS, is_encrypted=True))
    with TestClient(app, base_url=f"https://{HOST}", follow_redirects=False) as server:
        shown = server.get("/", params={"token": TOKENS[Role.VIEW]}, headers=A_PAGE)
        assert "Secure" in shown.headers["set-cookie"]
        own = {"origin": f"https://{HOST}"}
        assert server.get("/api/v1/health", headers=own).status_code == 200
        assert server.get("/api/v1/health", headers={"origin": f"http://{HOST}"}).status_code == 403


def test_behind_a_proxy_its_pages_are_those_of_the_address_that_it_is_reached_at(tmp_path: Path) -> None:
    public = "https://lab.example"
    app = create_app(data=tmp_path, access=Access(TOKENS, public_url=public))
    with TestClient(app, base_url="http://lab.example", follow_redirects=False) as server:
        shown = server.get("/", params={"token": TOKENS[Role.OPERATE]}, headers=A_PAGE)
        assert (shown.headers["location"], "Secure" in shown.headers["set-cookie"]) == ("/", True)
        # Whether the proxy passes the Host header on, or names the server by its own address.
        for host, origin, status in (
            ("lab.example", public, 200),
            ("LAB.example", "https://LAB.example", 200),
            ("127.0.0.1:8000", public, 200),
            ("127.0.0.1:8000", "http://127.0.0.1:8000", 200),
            ("lab.example", "http://lab.example", 403),
            ("lab.example", "https://lab.example:8443", 403),
            ("lab.example", "https://evil.example", 403),
            ("127.0.0.1:8000", "https://127.0.0.1:8000", 403),
        ):
            headers = {"host": host, "origin": origin, **LOOKS_ON}
            assert server.post(f"{DEVICES}/stop", headers=headers).status_code == status, (host, origin)
        refused = server.get("/", headers={"host": "127.0.0.1:8000", "origin": "https://evil.example"})
        assert "allowed: http://127.0.0.1:8000 or https://lab.example, or none." in message(refused)


def test_who_looks_on_computes_and_stops_and_changes_nothing(server: TestClient) -> None:
    route = f"{DEVICES}/{server.post(DEVICES, json={'port': 'sim://'}, headers=OPERATES).json()['id']}"
    assert server.post("/api/v1/profile", json={"design": document()}, headers=LOOKS_ON).status_code == 200
    assert server.get(route, headers=LOOKS_ON).status_code == 200
    assert server.post(f"{route}/push/preview", json={"design": document()}, headers=LOOKS_ON).status_code == 200
    for method, path in (
        ("POST", DEVICES), ("POST", f"{route}/push"), ("POST", f"{route}/move"), ("DELETE", route),
        ("PUT", f"{route}/soft_limits"), ("POST", f"{route}/control"), ("POST", "/api/v1/ports/find"),
        ("POST", f"{route}/stop/"), ("PUT", f"{route}/stop"), ("POST", f"{DEVICES}//stop"),
    ):  # fmt: skip
        refused = server.request(method, path, json={}, headers=LOOKS_ON)
        assert refused.status_code == 403, path
        assert message(refused).startswith("Your role is 'view'; allowed: to look on, to compute and to stop."), path
    with (
        pytest.raises(WebSocketDisconnect),
        server.websocket_connect(f"{route}/jog", headers={"host": HOST, **LOOKS_ON}),
    ):
        pass
    for path in (f"{DEVICES}/stop", f"{route}/stop", f"{route}/halt"):
        assert server.post(path, headers=LOOKS_ON).status_code == 200, path
    with server.websocket_connect(EVENTS, headers={"host": HOST, **LOOKS_ON}) as socket:
        socket.receive_json()
        socket.send_json({"do": "stop", "number": 1})
        until_did = next(each for each in iter(socket.receive_json, None) if "did" in each)
        assert until_did["did"]["do"] == "stop"


def test_every_route_that_changes_something_asks_for_the_role(server: TestClient) -> None:
    paths = server.get("/api/v1/openapi.json", headers=OPERATES).json()["paths"]
    asked = [(path, method) for path, methods in paths.items() for method in methods if method not in ("get", "head")]
    assert len(asked) > 30
    for path, method in asked:
        if path in COMPUTES or path.endswith(("/stop", "/halt", "/push/preview", "/library/search", "/pushes/search")):
            continue
        filled = path.replace("{device_id}", "1").replace("{name}", "x").replace("{", "").replace("}", "")
        assert server.request(method, filled, json={}, headers=LOOKS_ON).status_code == 403, (method, path)


def test_where_the_page_in_control_is_is_told(server: TestClient) -> None:
    with server.websocket_connect(f"{EVENTS}?page=one", headers={"host": HOST, **OPERATES}) as socket:
        socket.receive_json()
        by_page = {**OPERATES, "x-stepramp-page": "one"}
        route = f"{DEVICES}/{server.post(DEVICES, json={'port': 'sim://'}, headers=by_page).json()['id']}"
        device = server.get(route, headers=LOOKS_ON).json()
        assert (device["in_control"], device["in_control_at"]) == ("one", "testclient")
        refused = server.post(f"{route}/zero", json={}, headers={**OPERATES, "x-stepramp-page": "two"})
        assert "Another page at testclient is in control" in refused.text or refused.status_code == 422
        moved = server.post(f"{route}/move", json={"by_steps": 1}, headers={**OPERATES, "x-stepramp-page": "two"})
        assert "Another page at testclient is in control of" in message(moved)


def test_one_client_has_its_share_and_stops_are_free(server: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(client_limits, "MOST_AT_ONCE", 5)
    monkeypatch.setattr(client_limits, "MOST_PER_S", 0.001)
    statuses = [server.get("/api/v1/health", headers=LOOKS_ON).status_code for _ in range(7)]
    assert statuses == [200] * 5 + [429] * 2
    refused = server.get("/api/v1/health", headers=LOOKS_ON)
    assert int(refused.headers["retry-after"]) > 1
    assert all(server.post(f"{DEVICES}/stop", headers=LOOKS_ON).status_code == 200 for _ in range(9))


def test_browsers_at_one_address_have_a_share_together(server: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(client_limits, "MOST_AT_ONCE", 5)
    monkeypatch.setattr(client_limits, "MOST_PER_S", 0.001)
    monkeypatch.setattr(client_limits, "OF_A_PLACE", 3)
    statuses = []
    for _ in range(5):
        server.cookies.clear()
        signed_in(server, Role.VIEW)
        statuses.append([server.get("/api/v1/health").status_code for _ in range(4)])
    assert statuses == [[200] * 4] * 3 + [[200] * 3 + [429], [429] * 4]
    assert "at your address" in message(server.get("/api/v1/health"))
    assert server.get("/api/v1/health", headers=OPERATES).status_code == 200
    assert server.post(f"{DEVICES}/stop").status_code == 200


def test_sockets_of_browsers_at_one_address_are_counted_together(
    server: TestClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(client_limits, "MOST_SOCKETS", 1)
    monkeypatch.setattr(client_limits, "OF_A_PLACE", 2)
    browsers = []
    for _ in range(3):
        server.cookies.clear()
        signed_in(server, Role.VIEW)
        # Sockets of the test's client come in at port 80.
        browsers.append({"host": HOST, "cookie": f"stepramp-session-80={server.cookies['stepramp-session-8000']}"})
    one, other, more = (server.websocket_connect(EVENTS, headers=each) for each in browsers)
    with one, other:
        with pytest.raises(WebSocketDisconnect), more:
            pass
        with server.websocket_connect(EVENTS, headers={"host": HOST, **OPERATES}) as operates:
            assert operates.receive_json() == {"devices": []}


def test_jobs_and_sockets_of_one_client_are_counted(server: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(client_limits, "MOST_SOCKETS", 1)
    with (
        server.websocket_connect(EVENTS, headers={"host": HOST, **LOOKS_ON}) as socket,
        pytest.raises(WebSocketDisconnect),
        server.websocket_connect(EVENTS, headers={"host": HOST, **LOOKS_ON}),
    ):
        pass
    assert socket is not None
    with server.websocket_connect(EVENTS, headers={"host": HOST, **LOOKS_ON}) as again:
        assert again.receive_json() == {"devices": []}


def with_cookies(cookies: str) -> dict[str, Any]:
    """Return a request to port 1 with cookies."""
    return {"type": "http", "server": ("h", 1), "client": ("a", 2), "headers": [(b"cookie", cookies.encode())]}


def test_only_so_many_browsers_are_known_and_those_of_one_role_push_out_none_of_the_other() -> None:
    access = Access(TOKENS)
    looks_on, operates = (with_cookies(f"stepramp-session-1={access.begin_session(role)}") for role in Role)
    assert access.client_of(looks_on) is not None
    for _ in range(MOST_SESSIONS):
        access.begin_session(Role.VIEW)
    assert access.client_of(looks_on) is None
    assert access.client_of(operates) is not None


@pytest.mark.parametrize(
    "other",
    ['foo={"a":1}', "a b=1", "x=é", "foo", "foo[bar]=1", "session=a,b c", 'q="', "=", "", "stepramp-session-1=theirs"],
)
def test_cookies_of_other_programs_at_the_same_host_shut_nobody_out(other: str) -> None:
    access = Access(TOKENS)
    own = f"stepramp-session-1={access.begin_session(Role.OPERATE)}"
    for cookies in (f"{other}; {own}", f"{own}; {other}", f"{other};{own};{other}"):
        client = access.client_of(with_cookies(cookies))
        assert client is not None, cookies
        assert client.role is Role.OPERATE


def test_a_browser_that_is_known_stays_who_it_is_whatever_link_it_follows(server: TestClient) -> None:
    signed_in(server, Role.VIEW)
    looks_on = dict(server.cookies)
    signed_in(server, Role.VIEW)
    assert dict(server.cookies) == looks_on
    signed_in(server, Role.OPERATE)
    operates = dict(server.cookies)
    assert server.get("/api/v1/access").json()["role"] == "operate"
    for role in (Role.OPERATE, Role.VIEW):
        signed_in(server, role)
        assert dict(server.cookies) == operates
    assert server.get("/api/v1/access").json()["role"] == "operate"


def test_new_tokens_are_each_their_own() -> None:
    one, other = Access.with_new_tokens(), Access.with_new_tokens()
    tokens = {each.token_of(role) for each in (one, other) for role in Role}
    assert len(tokens) == 4
    assert min(map(len, tokens)) >= 32


def test_who_asked_what_is_kept(tmp_path: Path) -> None:
    app = create_app(data=tmp_path, access=Access(TOKENS))
    with TestClient(app, base_url=BASE) as server:
        route = f"{DEVICES}/{server.post(DEVICES, json={'port': 'sim://'}, headers=OPERATES).json()['id']}"
        server.get(route, headers=LOOKS_ON)
        pushed = server.post(f"{route}/push", json={"design": document(name="Zed ⚙")}, headers=OPERATES)
        assert pushed.status_code == 200
        server.post(f"{route}/move", json={"by_steps": 7}, headers={**OPERATES, "x-stepramp-page": "p"})
        server.post(f"{route}/move", json={"by_steps": 7}, headers=LOOKS_ON)
        server.post(f"{DEVICES}/stop", headers=LOOKS_ON)
        server.post("/api/v1/profile", json={"design": document()}, headers=LOOKS_ON)
        for _ in range(2):
            server.post(f"{route}/move", json={"by_steps": 3}, headers={**OPERATES, "Idempotency-Key": "one"})
    [file] = (tmp_path / "audit").iterdir()
    lines = [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]
    assert [(line["asked"], line["role"], line["status"]) for line in lines] == [
        (f"POST {DEVICES}", "operate", 200),
        (f"POST {route}/push", "operate", 200),
        (f"POST {route}/move", "operate", 200),
        (f"POST {route}/move", "view", 403),
        (f"POST {DEVICES}/stop", "view", 200),
        (f"POST {route}/move", "operate", 200),
        (f"POST {route}/move", "operate", 200),
    ]
    # It is written as it is answered, which may be long after it was asked for.
    assert all(line["asked_at"] <= line["at"] for line in lines)
    assert [line.get("repeats", False) for line in lines[-2:]] == [False, True]
    assert lines[1]["body"]["design"]["name"] == "Zed ⚙"
    assert (lines[2]["body"], lines[2]["page"], lines[2]["client"]) == ({"by_steps": 7}, "p", "testclient")


def test_who_looks_on_keeps_no_motor_running_by_the_name_of_another_s_page(server: TestClient) -> None:
    device = server.post(DEVICES, json={"port": "sim://"}, headers=OPERATES).json()["id"]
    route, its_own = f"{DEVICES}/{device}", OPERATES | {"x-stepramp-page": "one"}
    assert server.post(f"{route}/push", json={"design": document()}, headers=OPERATES).status_code == 200
    signed_in(server, Role.OPERATE)
    [session] = server.cookies.values()
    # For a WebSocket the test's client names another port of the server.
    browser = {"host": HOST, "cookie": "; ".join(f"{COOKIE}-{port}={session}" for port in (80, 8000))}
    with (
        server.websocket_connect(f"{EVENTS}?page=one", headers={"host": HOST, **LOOKS_ON}) as looking,
        # Of the same role, but another browser.
        server.websocket_connect(f"{EVENTS}?page=one", headers=browser) as other,
    ):
        looking.receive_json(), other.receive_json()
        with server.websocket_connect(f"{EVENTS}?page=one", headers={"host": HOST, **OPERATES}) as operating:
            operating.receive_json()
            run = {"speed_steps_per_s": 200, "for_s": 60}
            assert server.post(f"{route}/run", json=run, headers=its_own).json()["in_control"] == "one"
            assert server.post(f"{route}/run", json=run, headers={"x-stepramp-page": "one"}).status_code == 409
        until(lambda: server.get(route).json()["state"] == "ready")
        assert server.get(route).json()["in_control"] is None
