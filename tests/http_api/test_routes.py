"""Each route has an answer model, and models lie beside the routes that they are of."""

import threading
import warnings
from collections.abc import Callable, Iterator
from importlib import import_module
from inspect import iscoroutinefunction
from pkgutil import iter_modules
from types import ModuleType
from typing import Any, get_args

import pytest
from fastapi import APIRouter
from fastapi.dependencies.models import Dependant
from fastapi.routing import APIRoute
from pydantic import BaseModel
from starlette.testclient import TestClient

from stepramp import http_api
from stepramp.http_api import answer, app, error_items
from stepramp.http_api.answer import Answer
from stepramp.validation import Document

FILES = {
    "/export/{format}",
    "/library/file",
    "/devices/{device_id}/backups/{name}",
    "/backups/{source}/{name}",
    "/devices/{device_id}/trace.csv",
    "/report",
}
MODULES = [import_module(f"{http_api.__name__}.{each.name}") for each in iter_modules(http_api.__path__)]
OF_ALL_ROUTES = {answer.__name__, error_items.__name__}
"""What any answer is, and what any route answers to what goes wrong."""


def models_of(module: ModuleType) -> set[type]:
    own = (each for each in vars(module).values() if isinstance(each, type) and each.__module__ == module.__name__)
    return {each for each in own if issubclass(each, BaseModel)}


def test_every_route_answers_a_model_but_those_for_files() -> None:
    routers = [module.router for module in MODULES if hasattr(module, "router")]
    routes = [each for router in routers for each in router.routes if isinstance(each, APIRoute)]
    assert len(routes) > 30
    for route in routes:
        models = get_args(route.response_model) or (route.response_model,)
        answers = all(isinstance(model, type) and issubclass(model, (Answer, Document)) for model in models)
        assert answers != (route.path in FILES), route.path


def calls_of(dependant: Dependant) -> Iterator[Callable[..., Any]]:
    for each in dependant.dependencies:
        assert each.call is not None
        yield each.call
        yield from calls_of(each)


def test_no_dependency_waits_for_a_thread_of_those_that_read_the_page() -> None:
    routers = [module.router for module in MODULES if hasattr(module, "router")]
    dependants = [each.dependant for router in routers for each in router.routes if isinstance(each, APIRoute)]
    calls = {each for dependant in dependants for each in calls_of(dependant)}
    assert len(calls) > 10
    assert [each.__name__ for each in calls if not iscoroutinefunction(each)] == []


def test_models_lie_beside_the_routes_that_they_are_of() -> None:
    of_routes = [each for each in MODULES if each.__name__.endswith("_models")]
    assert len(of_routes) > 6
    for module in of_routes:
        routes = import_module(module.__name__.removesuffix("_models"))
        assert isinstance(routes.router, APIRouter)
        assert any(each in vars(routes).values() for each in models_of(module)), module.__name__


def test_models_lie_nowhere_else() -> None:
    elsewhere = [each for each in MODULES if not each.__name__.endswith("_models")]
    assert {each.__name__ for each in elsewhere if models_of(each)} == OF_ALL_ROUTES


def test_no_route_is_built_while_others_may_change_the_filters_of_warnings(monkeypatch: pytest.MonkeyPatch) -> None:
    """FastAPI builds them with filters of its own, and those are the whole process's: compiling sets others."""
    monkeypatch.setattr(app, "warm_up", lambda: None)
    built = app.create_app()

    catch_warnings = warnings.catch_warnings

    def change_filters(**options: Any) -> Any:
        # Applications of other tests may still be compiling.
        assert "warm_up" in threading.current_thread().name, "a route is built while requests are answered"
        return catch_warnings(**options)

    paths = ("devices", "ports", "methods", "examples")
    with TestClient(built, base_url="http://127.0.0.1:8000") as client, monkeypatch.context() as meanwhile:
        meanwhile.setattr(warnings, "catch_warnings", change_filters)
        answered = [client.get(f"/api/v1/{path}").status_code for path in paths]
        connected = client.post("/api/v1/devices", json={"port": "sim://"}).status_code
    assert (answered, connected) == ([200] * len(paths), 200)
