from pathlib import Path

import pytest
from starlette.testclient import TestClient, WebSocketDenialResponse
from starlette.websockets import WebSocketDisconnect

from stepramp.http_api.app import create_app

ROUTES = ["/", "/docs", "/api/v1/health", "/api/v1/ports", "/assets/plotly/plotly.min.js"]
EVENTS = "/api/v1/devices/events"
LOCAL = {"host": "127.0.0.1:8000"}
SOCKETS = (EVENTS, "/api/v1/devices/1/jog", "/api/v1/curves/socket")


@pytest.mark.parametrize("host", ["127.0.0.1:8000", "localhost:8000", "localhost", "[::1]:8000", "LOCALHOST:8000"])
def test_loopback_hosts_are_served(client: TestClient, host: str) -> None:
    assert client.get("/api/v1/health", headers={"host": host}).status_code == 200
    same = {"host": host, "origin": f"http://{host}"}
    assert client.get("/api/v1/health", headers=same).status_code == 200


def test_the_address_that_the_server_was_given_is_served(tmp_path: Path) -> None:
    client = TestClient(create_app(data=tmp_path, host="127.0.0.2"), base_url="http://127.0.0.2:8000")
    for host in ("127.0.0.2:8000", "127.0.0.1:8000"):
        same = {"host": host, "origin": f"http://{host}"}
        assert client.get("/api/v1/health", headers=same).status_code == 200
    for host in ("127.0.0.3:8000", "127x0.0.2:8000", "evil.example"):
        refused = client.get("/api/v1/health", headers={"host": host})
        assert refused.status_code == 403
        assert "allowed: 127.0.0.2, localhost, 127.0.0.1 or [::1]" in refused.text


@pytest.mark.parametrize("route", ROUTES)
@pytest.mark.parametrize(
    "host",
    ["evil.example", "evil.example:8000", "127.0.0.1.evil.example", "localhost.evil.example", "", "127.0.0.2:8000",
     "localhost:8000@evil.example", "user@localhost:8000:x", "0.0.0.0:8000", "127.0.0.1:8000@evil",
     "user@localhost:8000", "localhost:", "localhost.", "localhost.:8000", "127.0.0.1:0", "127.0.0.1:65536",
     "127.0.0.1:80x", "localhost/", "localhost?x", "localhost#x", "localhost:80/x", "localhost, localhost", "::1",
     "[::1", "[::1]x", "127.1", "2130706433", "127.0.0.1:\t80", "http://localhost"],
)  # fmt: skip
def test_other_hosts_are_refused_everywhere(client: TestClient, route: str, host: str) -> None:
    response = client.get(route, headers={"host": host})
    assert response.status_code == 403
    assert response.json()["errors"][0]["message"].startswith("The Host header is")


@pytest.mark.parametrize(
    "origin",
    ["http://evil.example", "https://127.0.0.1:8000", "http://127.0.0.1:9000", "http://localhost:8000", "null", "",
     "http://127.0.0.1:8000.evil.example", "http://127.0.0.1:8000/", "http://127.0.0.1:8000?", "http://u@127.0.0.1:8000",
     "http://127.0.0.1", "http://127.0.0.1:08000", "http://127.0.0.1:8000 http://127.0.0.1:8000"],
)  # fmt: skip
def test_pages_from_elsewhere_can_ask_for_nothing(client: TestClient, origin: str) -> None:
    headers = {"origin": origin}
    assert client.get("/api/v1/health", headers=headers).status_code == 403
    assert client.post("/api/v1/devices", json={"port": "sim://"}, headers=headers).status_code == 403
    assert client.options("/api/v1/devices", headers=headers).status_code == 403
    for socket in SOCKETS:
        with pytest.raises(WebSocketDisconnect), client.websocket_connect(socket, headers=headers):
            pass
    assert client.get("/api/v1/devices").json() == {"devices": []}


@pytest.mark.parametrize("socket", SOCKETS)
def test_a_websocket_for_another_host_is_refused(client: TestClient, socket: str) -> None:
    with pytest.raises(WebSocketDisconnect), client.websocket_connect(socket, headers={"host": "evil.example"}):
        pass


def test_a_websocket_of_our_own_page_is_served(client: TestClient) -> None:
    headers = {"origin": "http://127.0.0.1:8000", "host": "127.0.0.1:8000"}
    with client.websocket_connect(EVENTS, headers=headers) as socket:
        assert socket.receive_json() == {"devices": []}


def test_two_host_headers_are_refused(client: TestClient) -> None:
    request = client.build_request("GET", "/api/v1/health", headers=[("host", "127.0.0.1"), ("host", "evil.example")])
    assert client.send(request).status_code == 403


def test_two_origin_headers_are_refused(client: TestClient) -> None:
    origins = [("host", "127.0.0.1:8000"), ("origin", "http://127.0.0.1:8000"), ("origin", "http://127.0.0.1:8000")]
    assert client.send(client.build_request("GET", "/api/v1/health", headers=origins)).status_code == 403


@pytest.mark.parametrize("site", ["cross-site", "same-site", "none, cross-site", "", "SAME-ORIGIN"])
def test_what_other_sites_make_a_browser_ask_is_refused(client: TestClient, site: str) -> None:
    headers = {"sec-fetch-site": site}
    for route in ROUTES:
        refused = client.get(route, headers=headers)
        assert refused.status_code == 403
        assert refused.json()["errors"][0]["message"].startswith("The Sec-Fetch-Site header is")
    assert client.post("/api/v1/devices/stop", headers=headers).status_code == 403
    for socket in SOCKETS:
        with pytest.raises(WebSocketDisconnect), client.websocket_connect(socket, headers=LOCAL | headers):
            pass


@pytest.mark.parametrize("site", ["same-origin", "none"])
def test_what_our_own_pages_ask_is_answered(client: TestClient, site: str) -> None:
    assert client.get("/api/v1/health", headers={"sec-fetch-site": site}).status_code == 200
    with client.websocket_connect(EVENTS, headers=LOCAL | {"sec-fetch-site": site}) as socket:
        assert socket.receive_json() == {"devices": []}


def test_a_link_from_elsewhere_opens_the_page_but_nothing_of_the_api(client: TestClient) -> None:
    followed = {"sec-fetch-site": "cross-site", "sec-fetch-mode": "navigate", "sec-fetch-dest": "document"}
    assert client.get("/", headers=followed).status_code == 200
    assert client.get("/api/v1/devices", headers=followed).status_code == 403
    assert client.post("/", headers=followed).status_code == 403
    assert client.get("/", headers=followed | {"sec-fetch-dest": "iframe"}).status_code == 403


def mistaken() -> None:
    raise ZeroDivisionError


@pytest.mark.parametrize(
    ("method", "route", "status", "headers"),
    [
        *(("GET", route, 200, {}) for route in ROUTES),
        ("GET", "/api/v1/health", 403, {"host": "evil.example"}),
        ("GET", "/", 403, {"origin": "http://evil.example"}),
        ("GET", "/api/v1/nothing", 404, {}),
        ("GET", "/nothing.html", 404, {}),
        ("GET", "/assets/plotly/nothing.js", 404, {}),
        ("PUT", "/api/v1/health", 405, {}),
        ("PUT", "/index.html", 405, {}),
        ("POST", "/api/v1/profile", 413, {"content-type": "application/json", "content-length": "2000001"}),
        ("POST", "/api/v1/profile", 415, {}),
        ("POST", "/api/v1/profile", 422, {"content-type": "application/json"}),
        ("GET", "/api/v1/mistake", 500, {}),
    ],
)
def test_every_answer_is_kept_from_other_sites(
    client: TestClient, method: str, route: str, status: int, headers: dict[str, str]
) -> None:
    client.app.add_api_route("/api/v1/mistake", mistaken)
    answer = client.request(method, route, headers=headers)
    assert answer.status_code == status
    names = ("content-security-policy", "x-content-type-options", "cross-origin-resource-policy", "referrer-policy")
    policy, *others = (answer.headers.get_list(name) for name in names)
    assert others == [["nosniff"], ["same-origin"], ["no-referrer"]]
    assert "default-src 'self'" in policy[0]
    assert "frame-ancestors 'none'" in policy[0]
    assert "access-control-allow-origin" not in answer.headers
    if status >= 400:
        assert answer.headers["content-type"] == "application/json"
        assert answer.json()["errors"][0]["message"]


def test_a_websocket_is_refused_with_the_reason(client: TestClient) -> None:
    headers = LOCAL | {"origin": "http://evil.example"}
    with pytest.raises(WebSocketDenialResponse) as caught, client.websocket_connect(EVENTS, headers=headers):
        pass
    assert caught.value.status_code == 403
    assert "The Origin header is" in caught.value.json()["errors"][0]["message"]
    assert "content-security-policy" in caught.value.headers


@pytest.mark.parametrize("path", ["/api/v1/nothing", "/api/v1/health", "/index.html", "/api/v1/devices/1/jogg"])
def test_a_websocket_that_is_not_there_is_refused_with_the_reason(client: TestClient, path: str) -> None:
    with pytest.raises(WebSocketDenialResponse) as caught, client.websocket_connect(path, headers=LOCAL):
        pass
    assert caught.value.status_code == 404
    assert f"There is no WebSocket {path}." in caught.value.json()["errors"][0]["message"]
