import json
import subprocess
import sys
from pathlib import Path

import pytest

import stepramp
from designs import document
from stepramp.command_line import files, history
from stepramp.command_line.main import main
from stepramp.http_api import bodies

BACKEND = Path(stepramp.__file__).parents[1]


def test_a_design_is_exported_to_a_file(tmp_path: Path) -> None:
    (tmp_path / "design.json").write_text(json.dumps(document(name="Stage", move__steps=7)))
    assert main(["export", "csv", str(tmp_path / "design.json"), str(tmp_path / "steps.csv")]) == 0
    assert len((tmp_path / "steps.csv").read_text().splitlines()) == 8
    assert main(["export", "grbl", "--axis-letter", "Z", str(tmp_path / "design.json"), str(tmp_path / "z.txt")]) == 0
    # 200 · 2 / 8 = 50 steps/mm.
    assert "\n$102=50\n" in (tmp_path / "z.txt").read_text()
    image, coarse = tmp_path / "fine.h", tmp_path / "coarse.h"
    assert main(["export", "c_ramp_image", str(tmp_path / "design.json"), str(image)]) == 0
    bound = ["--segment-bound-ticks", "20"]
    assert main(["export", "c_ramp_image", *bound, str(tmp_path / "design.json"), str(coarse)]) == 0
    assert len(coarse.read_text()) < len(image.read_text())


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be"])
def test_a_design_is_read_in_whatever_encoding_an_editor_saved_it(tmp_path: Path, encoding: str) -> None:
    text = json.dumps(document(name="Größe", move__steps=7), ensure_ascii=False)
    (tmp_path / "design.json").write_text(text, encoding=encoding)
    assert main(["export", "json", str(tmp_path / "design.json"), str(tmp_path / "again.json")]) == 0
    assert json.loads((tmp_path / "again.json").read_bytes())["name"] == "Größe"


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="has no file without an end")
def test_a_file_without_an_end_is_no_design(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["export", "csv", "/dev/zero", "-"]) == 2
    assert "(it is larger than 2,000,000 bytes)" in capsys.readouterr().err


@pytest.mark.skipif(sys.platform == "win32", reason="has no limit of a file's size")
def test_what_was_there_before_stays_when_a_file_can_t_be_written_whole(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("steps.csv").write_text("before")
    Path("steps.csv").chmod(0o640)
    Path("link.csv").symlink_to("steps.csv")
    script = f"""
import resource, signal, sys
sys.path.insert(0, {str(BACKEND)!r})
from stepramp.command_line.files import write
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (5000, 5000))
write("link.csv", b"x" * int(sys.argv[1]))
"""
    told = subprocess.run([sys.executable, "-c", script, "6000"], capture_output=True, text=True, check=False).stderr
    assert "FILE is 'link.csv'; allowed: a file that can be written (File too large)" in told
    assert Path("steps.csv").read_text() == "before"
    subprocess.run([sys.executable, "-c", script, "4000"], check=True)
    assert Path("steps.csv").read_text() == "x" * 4000
    assert Path("steps.csv").stat().st_mode & 0o777 == 0o640
    assert sorted(each.name for each in tmp_path.iterdir()) == ["link.csv", "steps.csv"]


@pytest.mark.parametrize("way", ["the same", "another spelling", "a link"])
def test_a_design_is_not_overwritten_by_what_is_made_of_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], way: str
) -> None:
    monkeypatch.chdir(tmp_path)
    text = json.dumps(document())
    Path("design.json").write_text(text)
    Path("link.json").symlink_to("design.json")
    target = {"the same": "design.json", "another spelling": f"../{tmp_path.name}/design.json", "a link": "link.json"}
    assert main(["export", "c_newton", "design.json", target[way]]) == 2
    told = f"stepramp: FILE is {target[way]!r}; allowed: another file than that of the design.\n"
    assert capsys.readouterr().err == told
    assert Path("design.json").read_text() == text


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["pdf", "design.json", "-"], "FORMAT is 'pdf'; allowed: c_table, c_table_progmem"),
        (["grbl", "design.json", "-", "--axis-letter", "z"], "--axis-letter is 'z'; allowed: X, Y, Z, A, B, C."),
        (["csv", "design.json", "-", "--segment-bound-ticks", "-1"], "--segment-bound-ticks is -1; allowed: "),
        (["csv", "absent.json", "-"], "DESIGN is 'absent.json'; allowed: a file with a design document (No such"),
        (
            ["csv", "text.json", "-"],
            "DESIGN is 'text.json'; allowed: a file with a design document (it is no JSON: line 1",
        ),
        (
            ["csv", "latin.json", "-"],
            "DESIGN is 'latin.json'; allowed: a file with a design document (it is no text in UTF-8 or UTF-16).",
        ),
        (
            ["csv", "large.json", "-"],
            "DESIGN is 'large.json'; allowed: a file with a design document (it is larger than 2,000,000 bytes).",
        ),
        (["csv", "empty.json", "-"], "DESIGN is 'empty.json'; allowed: a file with a design document (it is empty)."),
        (["csv", "design.json", "."], "FILE is '.'; allowed: a file that can be written (Is a directory)."),
        (["csv", "twice.json", "-"], 'name is ["A", "B"]; allowed: one value, given once.'),
        (["csv", "wrong.json", "-"], "timer.frequency_hz is 0; allowed: a number from 1,000"),
        (["csv", "design.json", "absent/steps.csv"], "FILE is 'absent/steps.csv'; allowed: a file that can be written"),
    ],
)
def test_what_can_t_be_exported_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], words: list[str], message: str
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("design.json").write_text(json.dumps(document()))
    Path("text.json").write_text("not JSON")
    Path("latin.json").write_bytes(b'{"name": "Rampe f\xfcr Zeiger"}')
    Path("large.json").write_bytes(b" " * 2_000_001)
    Path("empty.json").write_text("\n")
    Path("twice.json").write_text('{"name": "A", "name": "B"}')
    Path("wrong.json").write_text(json.dumps(document(timer__frequency_hz=0)))
    assert main(["export", *words]) == 2
    assert capsys.readouterr().err.startswith(f"stepramp: {message}")


@pytest.mark.parametrize("source", ["/dev/zero", "-"])
@pytest.mark.skipif(sys.platform == "win32", reason="files without an end of Unix")
def test_a_capture_without_an_end_is_refused(
    source: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert (files.MOST_FILE_BYTES, history.MOST_LIBRARY_BYTES) == (bodies.MOST_FILE_BYTES, bodies.MOST_LIBRARY_BYTES)
    monkeypatch.setattr(files, "MOST_FILE_BYTES", 100_000)
    with Path("/dev/zero").open() as endless:
        monkeypatch.setattr(sys, "stdin", endless)
        assert main(["capture", source, "--alone"]) == 2
    assert capsys.readouterr().err == f"stepramp: FILE is '{source}'; allowed: a file of up to 100,000 bytes.\n"
