import importlib.util
import json
import re
from pathlib import Path

from stepramp.http_api.app import create_app

DOCS = Path(__file__).parents[1] / "docs"


def test_the_tables_of_the_methods_are_those_that_the_script_makes() -> None:
    found = importlib.util.spec_from_file_location("make_method_tables", DOCS / "make_method_tables.py")
    assert found is not None
    assert found.loader is not None
    script = importlib.util.module_from_spec(found)
    found.loader.exec_module(script)
    written = (DOCS / "methods.md").read_text(encoding="utf-8").split(script.MARK)[1]
    assert written == "\n" + script.tables(), "run: .venv/bin/python docs/make_method_tables.py"


def test_the_description_of_the_api_is_that_of_the_server() -> None:
    committed = json.loads((DOCS / "openapi.json").read_text(encoding="utf-8"))
    again = "run: .venv/bin/python docs/make_openapi.py"
    assert committed == json.loads(json.dumps(create_app().openapi())), again


def test_each_fault_names_tests_that_are_there() -> None:
    named = re.findall(r"`([^`]*test_[^`]*)`", (DOCS / "faults.md").read_text(encoding="utf-8"))
    assert len(named) > 30
    source = ""
    for name in named:
        # As tests/folder/test_file.py::test_name, or test_name of the file named before it.
        path, _, function = name.rpartition("::") if not name.endswith(".py") else (name, "", "")
        source = (DOCS.parent / path).read_text(encoding="utf-8") if path else source
        assert not function or f"def {function}(" in source, name


def test_the_files_that_the_architecture_names_are_there() -> None:
    named = re.findall(
        r"`([a-z_]+(?:/[\w./]*)?\.[a-z]+|[a-z_]+/[\w/]*)`", (DOCS / "architecture.md").read_text("utf-8")
    )
    assert len(named) > 60
    project = DOCS.parent
    missing = [
        name
        for name in named
        if not any((root / name).exists() for root in (project, project / "backend/stepramp", project / "frontend"))
    ]
    assert missing == []


def test_the_page_on_adding_a_family_is_true_to_the_files() -> None:
    """Each file that it names is there, and each name of code is in one of the example's files, or of the contract."""
    text = (DOCS / "adding_a_family.md").read_text("utf-8")
    project, controllers = DOCS.parent, DOCS.parent / "backend/stepramp/controllers"
    quoted = set(re.findall(r"`([^`]+)`", text))
    files = {each for each in quoted if re.fullmatch(r"[\w./]+\.(?:py|js|md)|[\w/]+/", each)}
    roots = (project, controllers.parent, controllers, controllers / "tic")
    assert [each for each in sorted(files) if not any((root / each).exists() for root in roots)] == []
    assert len(files) > 30
    # Each module of the example is told of.
    assert {each.name for each in (controllers / "tic").glob("[a-z]*.py")} <= files
    names = {each for each in quoted - files if re.fullmatch(r"\w+(?:\.\w+)?", each)}
    where = [
        *(controllers / "tic").glob("*.py"),
        *controllers.glob("*.py"),
        *(project / "backend/stepramp").glob("*.py"),
    ]
    where.append(project / "backend/stepramp/link/connection.py")
    source = "\n".join(each.read_text("utf-8") for each in where)
    missing = [name for name in sorted(names) if not re.search(rf"\b{name.rpartition('.')[2]}\b", source)]
    assert (missing, len(names) > 20) == ([], True)


def test_the_index_leads_to_each_document() -> None:
    linked = set(re.findall(r"\]\((?!\.\.)([\w./]+?)/?\)", (DOCS / "README.md").read_text("utf-8")))
    documents = {each.name for each in DOCS.iterdir() if each.suffix in (".md", ".json") and each.name != "README.md"}
    assert linked == documents | {"decisions"}


def test_the_decisions_are_numbered_without_a_gap_and_say_their_number() -> None:
    decisions = sorted((DOCS / "decisions").iterdir())
    numbers = range(1, len(decisions) + 1)
    assert [each.name[:5] for each in decisions] == [f"{number:04}-" for number in numbers]
    titles = [each.read_text("utf-8").partition("\n")[0] for each in decisions]
    assert [title for title, number in zip(titles, numbers, strict=True) if not title.startswith(f"# {number}. ")] == []
    named = {
        target
        for document in (*DOCS.glob("*.md"), *decisions, *DOCS.parent.glob("*.md"))
        for target in re.findall(r"decisions/(\d{4}-[\w-]+\.md)", document.read_text("utf-8"))
    }
    assert named <= {each.name for each in decisions}
