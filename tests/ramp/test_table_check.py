import pytest

from stepramp.ramp.table_check import check_table, mean_acceleration, row_changes

PUBLISHED = [(10, 5000), (30, 1500), (100, 1000), (150, 800), (300, 600)]


def test_the_published_table_asks_for_jumps_far_above_its_mean() -> None:
    # v = 1/600 µs from step 150 on: v² / 300 = 9,259 steps/s²; the first row change is (667² - 200²) / 2.
    assert mean_acceleration(PUBLISHED) == pytest.approx(9259.26, abs=0.01)
    changes = [change.acceleration_steps_per_s2 for change in row_changes(PUBLISHED)]
    assert changes == pytest.approx([20_000, 202_222.2, 277_777.8, 281_250, 607_638.9], abs=0.1)
    findings = check_table(PUBLISHED, 600)
    assert [finding.row for finding in findings] == [1, 2, 3, 4]
    assert "202,222 steps/s²" in findings[0].reason
    assert "9,259 steps/s²" in findings[0].reason
    assert not any(finding.wrong for finding in findings)


@pytest.mark.parametrize(
    ("rows", "row", "reason", "wrong"),
    [
        ([(10, 500), (10, 400)], 1, "ramp index 10 does not increase", True),
        ([(10, 500), (20, 600)], 1, "delay 600 µs rises", False),
        ([(10, 70_000), (20, 69_000)], 0, "delay 70,000 is wider than 16 bits", True),
        ([(10, 500), (70_000, 400)], 1, "ramp index 70,000 is wider than 16 bits", True),
        ([(10, 500), (20, 400)], 1, "the last row is missing", False),
    ],
)
def test_findings_name_row_and_reason(rows: list[tuple[int, int]], row: int, reason: str, wrong: bool) -> None:
    found = [(finding.row, finding.wrong) for finding in check_table(rows, 100) if reason in finding.reason]
    assert found == [(row, wrong)]


def test_a_smooth_table_has_no_findings() -> None:
    rows = [(k, round(1e6 / (2 * 5000 * k) ** 0.5)) for k in range(1, 101)]
    assert check_table(rows, 1000) == []
