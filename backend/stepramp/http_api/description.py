"""What the description of the API has besides the routes: where it is served, who may ask, and examples."""

from typing import Any

from pydantic import BaseModel
from pydantic.json_schema import models_json_schema

from stepramp.http_api.access import COOKIE
from stepramp.http_api.curves_models import CurvesAnswer, CurvesPayload
from stepramp.http_api.devices_models import DevicesAnswer
from stepramp.http_api.error_items import ErrorList
from stepramp.http_api.idempotency import ALLOWED_KEY, KEY_HEADER, REPLAYED_HEADER
from stepramp.http_api.jog_models import JogPayload
from stepramp.http_api.request_examples import EXAMPLES
from stepramp.http_api.sign_in import acts
from stepramp.http_api.stopping_models import StopMessage, StopMessageAnswer

API = "/api/v1"
_METHODS = ("get", "put", "post", "delete")
_SERVERS = [{"url": "/", "description": "The server that this comes from; usually http://127.0.0.1:8000"}]
_SCHEMES = {
    "token": {
        "type": "http",
        "scheme": "bearer",
        "description": "Of a server for other machines: the token of a role, which it printed when it was started",
    },
    "session": {
        "type": "apiKey",
        "in": "cookie",
        "name": COOKIE,
        "description": "The same for a browser: the link with the token sets it. Its name ends in - and the port",
    },
}
_SECURITY: list[dict[str, list[str]]] = [{}, {"token": []}, {"session": []}]
"""Nothing where the server listens on its own machine only; else one of them."""
_KEY = {
    "name": KEY_HEADER,
    "in": "header",
    "required": False,
    "schema": {"type": "string", "minLength": 1, "maxLength": 200, "pattern": "^[!-~]+$"},
    "description": f"What stands for this one request: {ALLOWED_KEY}. Asked again with it within a day, it is not done "
    f"again, but answered as it was, with `{REPLAYED_HEADER}: true`; what was refused may be asked again, and moves "
    "nothing after a stop since",
}


_SOCKETS: dict[str, tuple[str, list[type[BaseModel]], list[type[BaseModel]]]] = {
    "/devices/events": ("What changes of the devices; stops", [DevicesAnswer, StopMessageAnswer], [StopMessage]),
    "/devices/{device_id}/jog": ("An axis that runs as long as a button is held", [ErrorList], [JogPayload]),
    "/curves/socket": ("Curves, for sliders", [CurvesAnswer, ErrorList], [CurvesPayload]),
}
"""Of each WebSocket: what it is for, what it sends, and what it takes."""


def complete(described: dict[str, Any]) -> None:
    """Add to the framework's description what it doesn't know."""
    described["x-websockets"] = {
        f"{API}{path}": {"description": what, "sends": _any_of(sent), "takes": _any_of(taken)}
        for path, (what, sent, taken) in _SOCKETS.items()
    }
    schemas = described["components"]["schemas"]
    schemas.update({name: schema for name, schema in _schemas_of_messages().items() if name not in schemas})
    described["servers"] = _SERVERS
    described["security"] = _SECURITY
    described["components"]["securitySchemes"] = _SCHEMES
    for path, operations in described["paths"].items():
        for method in _METHODS:
            if method in operations:
                _complete_operation(path, method, operations[method])
    _link_devices(described["paths"])


def _any_of(models: list[type[BaseModel]]) -> dict[str, Any]:
    return {"anyOf": [{"$ref": f"#/components/schemas/{each.__name__}"} for each in models]}


def _schemas_of_messages() -> dict[str, Any]:
    """Return the schemas of what goes over WebSockets, and of what they consist of."""
    sent = [(each, "serialization") for _, models, _ in _SOCKETS.values() for each in models]
    taken = [(each, "validation") for _, _, models in _SOCKETS.values() for each in models]
    _, schemas = models_json_schema(sorted({*sent, *taken}, key=str), ref_template="#/components/schemas/{model}")  # type: ignore[arg-type]
    return dict(sorted(schemas["$defs"].items()))


def _complete_operation(path: str, method: str, operation: dict[str, Any]) -> None:
    bodies = operation.get("requestBody", {}).get("content", {})
    if "application/json" in bodies and path.removeprefix(API) in EXAMPLES:
        bodies["application/json"]["example"] = EXAMPLES[path.removeprefix(API)]
    if acts({"type": "http", "path": path, "method": method.upper()}):
        operation.setdefault("parameters", []).append(_KEY)


def _link_devices(paths: dict[str, Any]) -> None:
    """Say of connecting where the device's id can be used."""
    used = [operations for path, operations in paths.items() if "{device_id}" in path]
    names = [operation["operationId"] for operations in used for operation in operations.values()]
    paths[f"{API}/devices"]["post"]["responses"]["200"]["links"] = {
        name: {"operationId": name, "parameters": {"device_id": "$response.body#/id"}} for name in names
    }
