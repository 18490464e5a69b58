import pytest
from starlette.testclient import TestClient
from starlette.websockets import WebSocketDisconnect

ROUTES = ["/", "/docs", "/api/v1/health", "/api/v1/ports", "/assets/plotly/plotly.min.js"]
EVENTS = "/api/v1/devices/events"
SOCKETS = (EVENTS, "/api/v1/devices/1/jog", "/api/v1/curves/socket")


@pytest.mark.parametrize("host", ["127.0.0.1:8000", "localhost:8000", "localhost", "[::1]:8000", "LOCALHOST:8000"])
def test_loopback_hosts_are_served(client: TestClient, host: str) -> None:
    assert client.get("/api/v1/health", headers={"host": host}).status_code == 200
    same = {"host": host, "origin": f"http://{host}"}
    assert client.get("/api/v1/health", headers=same).status_code == 200


@pytest.mark.parametrize("route", ROUTES)
@pytest.mark.parametrize(
    "host",
    ["evil.example", "evil.example:8000", "127.0.0.1.evil.example", "localhost.evil.example", "", "127.0.0.2:8000",
     "localhost:8000@evil.example", "user@localhost:8000:x", "0.0.0.0:8000"],
)  # fmt: skip
def test_other_hosts_are_refused_everywhere(client: TestClient, route: str, host: str) -> None:
    response = client.get(route, headers={"host": host})
    assert response.status_code == 403
    assert response.json()["errors"][0]["message"].startswith("The Host header is")


@pytest.mark.parametrize(
    "origin",
    ["http://evil.example", "https://127.0.0.1:8000", "http://127.0.0.1:9000", "http://localhost:8000", "null", "",
     "http://127.0.0.1:8000.evil.example"],
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


def test_answers_forbid_what_comes_from_elsewhere(client: TestClient) -> None:
    for route in ROUTES:
        headers = client.get(route).headers
        assert "default-src 'self'" in headers["content-security-policy"]
        assert "frame-ancestors 'none'" in headers["content-security-policy"]
        assert "access-control-allow-origin" not in headers
