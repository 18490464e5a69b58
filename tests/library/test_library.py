"""The library, on both databases: what is kept, found and never overwritten."""

import threading

import pytest

from designs import design
from stepramp.errors import NotFound, Outdated, Rejected
from stepramp.library.differences import Difference, differences
from stepramp.library.library import About, Library


def test_every_save_is_kept_and_can_be_returned_to(library: Library) -> None:
    kept = library.add(design(move__steps=100), About("Lift"), "first")
    kept = library.save(kept.id, kept.version, design(move__steps=200), "second")
    # To return is to save what was before.
    kept = library.save(kept.id, kept.version, design(move__steps=100))
    told, history = library.get(kept.id)
    assert told == kept
    assert (kept.revisions, kept.version) == (3, 3)
    assert [(each.number, each.note) for each in history] == [(3, ""), (2, "second"), (1, "first")]
    assert [library.content(kept.id, number)["move"] for number in (1, 2, 3)] == [  # type: ignore[index]
        {"steps": 100},
        {"steps": 200},
        {"steps": 100},
    ]
    assert history[0].content_hash == history[2].content_hash != history[1].content_hash


def test_a_change_of_an_old_version_overwrites_nothing(library: Library) -> None:
    kept = library.add(design(), About("Lift"))
    library.describe(kept.id, kept.version, About("Hoist", "of the left tower", ["tower"]))
    with pytest.raises(Outdated, match=r"'Hoist' was changed .* version 1, it is at 2"):
        library.save(kept.id, kept.version, design(move__steps=5))
    with pytest.raises(Outdated):
        library.describe(kept.id, kept.version, About("Mine"))
    told, history = library.get(kept.id)
    assert (told.name, told.notes, told.tags, len(history)) == ("Hoist", "of the left tower", ["tower"], 1)


def test_of_many_who_save_at_once_one_succeeds(library: Library) -> None:
    kept = library.add(design(), About("Lift"))
    together, outcomes = threading.Barrier(8), []

    def save(steps: int) -> None:
        together.wait(30)
        try:
            library.save(kept.id, kept.version, design(move__steps=steps))
            outcomes.append("saved")
        except Outdated:
            outcomes.append("outdated")

    threads = [threading.Thread(target=save, args=[number + 1]) for number in range(8)]
    for each in threads:
        each.start()
    for each in threads:
        each.join()
    assert sorted(outcomes) == ["outdated"] * 7 + ["saved"]
    assert library.get(kept.id)[0].revisions == 2


def test_designs_are_found_by_words_and_tags(library: Library) -> None:
    library.add(design(), About("Größe Äpfel", "100% sure", ["fruit"]))
    library.add(design(), About("Pears", "under_score", ["fruit", "green"]))

    def found(text: str = "", *tags: str) -> list[str]:
        return [each.name for each in library.search(text, tags)[1]]

    assert found() == ["Pears", "Größe Äpfel"]
    assert found("äPFEL") == found("grösse") == found("0%") == ["Größe Äpfel"]
    assert found("r_s") == found("", "fruit", "green") == found("PEARS fruit") == ["Pears"]
    assert found("%") == ["Größe Äpfel"]
    assert found("pears apples") == found("", "gree") == []
    count, page = library.search(first=1, most=1)
    assert (count, [each.name for each in page]) == (2, ["Größe Äpfel"])


def test_a_copy_is_a_design_of_its_own(library: Library) -> None:
    kept = library.add(design(move__steps=7), About("Lift", "notes", ["a", "b"]))
    copy = library.duplicate(kept.id, "Lift 2")
    library.save(copy.id, copy.version, design(move__steps=8))
    assert (copy.name, copy.notes, copy.tags) == ("Lift 2", "notes", ["a", "b"])
    assert library.get(kept.id)[0] == kept


def test_what_is_not_there_and_what_cannot_be_kept_is_said(library: Library) -> None:
    kept = library.add(design(), About("Lift"))
    for design_id in ("0" * 32, "x\0", ""):
        with pytest.raises(NotFound, match="There is no design"):
            library.get(design_id)
    for number in (0, 2):
        with pytest.raises(NotFound, match=f"no revision {number}"):
            library.content(kept.id, number)
    with pytest.raises(Rejected, match=r"tags\.1 is .*; allowed: text without the character NUL"):
        About("a", tags=["b", "c\0"])
    with pytest.raises(Rejected, match="note is"):
        library.save(kept.id, kept.version, design(), "\0")
    assert library.get(kept.id)[0] == kept


def test_differences_name_fields_of_either() -> None:
    before = {"a": {"b": 1, "c": 2}, "rows": [[1, 2]], "gone": {"x": 1}}
    after = {"a": {"b": 1, "c": 3}, "rows": [[1, 3]], "new": None, "more": 0}
    assert list(differences(before, after)) == [
        Difference("a.c", 2, 3),
        Difference("rows", [[1, 2]], [[1, 3]]),
        Difference("gone", {"x": 1}, None),
        Difference("more", None, 0),
    ]
