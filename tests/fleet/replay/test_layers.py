"""The parts that rows are made by, each by itself."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fleet.replay.colormap import TABLE, energy_colours
from fleet.replay.columns import Index, Moment, pairs, segments, strips
from fleet.replay.layers.arrows import Growing, rim_to_rim
from fleet.replay.layers.drives import dashes
from fleet.replay.layers.frames import frames
from fleet.replay.layers.label_placement import LabelPlacement
from fleet.replay.layers.lifetime import ticks

AT = Moment(0.0, 1, 1, 0.0)


class TestFrames:
    @given(st.data())
    def test_everybody_keeps_the_latest_pose(self, data):
        movers = data.draw(st.lists(st.integers(0, 9), unique=True, min_size=1, max_size=4))
        started = {r: data.draw(st.sampled_from([0.0, 0.35])) for r in movers}
        times = data.draw(st.lists(st.integers(1, 9), min_size=1, max_size=12))
        samples = sorted(
            (0.1 * t, data.draw(st.sampled_from(movers)), float(k)) for k, t in enumerate(times)
        )
        samples = [row for row in samples if row[0] > started[row[1]]]
        if not samples:
            return
        table = np.array([[r, t, x, -x, 0.5, 9.0] for t, r, x in samples])
        poses = {r: (r, started[r], -1.0, 1.0, 0.0, 10.0) for r in movers}
        if len(movers) == 1:
            table = table[np.append(np.diff(table[:, 1]) > 0, True)]
        when, lengths, rows = frames(table, dict(poses), AT)

        row = iter(rows.tolist())
        for time, length in zip(when.times.tolist(), lengths.tolist(), strict=True):
            shown = {}
            for _ in range(length):
                robot, at, x, *_ = next(row)
                assert at == time
                shown[robot] = x
            expected = {}
            for robot in movers:
                if started[robot] <= time:
                    seen = [s for s in table.tolist() if s[0] == robot and s[1] <= time]
                    expected[robot] = seen[-1][2] if seen else -1.0
            assert shown == expected
        assert next(row, None) is None


class TestGrowing:
    @given(st.lists(st.integers(1, 5), min_size=1, max_size=400))
    def test_what_is_drawn_and_what_is_loose_is_all(self, sizes):
        growing, total, written = Growing(), [], 0
        for k, size in enumerate(sizes, 1):
            new = [(float(k), float(i), 0.0, 0.0) for i in range(size)]
            total += new
            growing.extend(Moment(0.0, 1, k, 0.0), new)
            drawn = 0 if not growing.rows else growing.rows[-1][2]
            assert [*growing.items[:drawn], *growing.loose] == total
        written = sum(end - start for _, start, end in growing.rows)
        assert written <= 60 * len(total)  # not the square of it
        growing.complete(Moment(0.0, 1, len(sizes) + 1, 0.0))
        assert growing.rows[-1][1:] == (0, len(total))
        growing.restart(Moment(0.0, 2, len(sizes) + 1, 0.0))
        assert growing.rows[-1][1] == growing.rows[-1][2]

    def test_what_was_sent_is_forgotten(self):
        growing = Growing()
        growing.extend(AT, [(0.0, 0.0, 1.0, 1.0)])
        growing.restart(AT)
        growing.extend(AT, [(2.0, 0.0, 1.0, 1.0)])
        growing.forget()
        assert growing.items == [(2.0, 0.0, 1.0, 1.0)]
        growing.extend(AT, [(3.0, 0.0, 1.0, 1.0)])
        assert growing.rows == [(AT, 0, 2)]


def test_opposite_arrows_lie_side_by_side():
    ends = np.array([[0.0, 0.0, 4.0, 3.0], [4.0, 3.0, 0.0, 0.0]])
    origins, vectors = rim_to_rim(ends, 0.1)
    assert vectors[0] == pytest.approx(-vectors[1])
    across = np.array([-0.6, 0.8])
    assert across @ origins[0] < 0.0 < across @ origins[1]
    assert np.hypot(*vectors[0]) < 5.0


def test_labels_keep_off_each_other():
    labels = LabelPlacement((10.0, 10.0))
    labels.clear()
    boxes = []
    for (x, y), letters in (((5.0, 5.0), 8), ((5.0, 5.2), 12), ((5.3, 5.0), 9)):
        boxes.append((*labels.place(x, y, letters), 0.21 * letters))
    for k, (x, y, width) in enumerate(boxes):
        for ox, oy, other in boxes[:k]:
            assert abs(x - ox) >= 0.5 * (width + other) - 1e-9 or abs(y - oy) >= 0.42 - 1e-9


def test_labels_keep_off_what_is_to_be_seen():
    labels = LabelPlacement((10.0, 10.0))
    labels.clear()
    assert labels.place(5.0, 5.0, 8)[1] > 5.2
    labels.clear()
    labels.keep_off((5.0, 5.4))
    assert labels.place(5.0, 5.0, 8)[1] < 5.0


def test_labels_keep_off_the_scales_beside_the_floor():
    for anchor in ((0.05, 5.0), (9.95, 5.0)):
        labels = LabelPlacement((10.0, 10.0))
        labels.clear()
        x, _ = labels.place(*anchor, 14)
        assert 0.5 * 14 * 0.21 - 0.2 <= x <= 10.2 - 0.5 * 14 * 0.21


def test_labels_stay_in_sight():
    for anchor in ((5.0, 0.1), (5.0, 9.9), (0.1, 9.9)):
        labels = LabelPlacement((10.0, 10.0))
        labels.clear()
        for _ in range(3):
            _, y = labels.place(*anchor, 10)
            assert 0.21 - 1e-9 <= y - 0.2 <= 10.0


def test_labels_hide_few_robots():
    row = np.column_stack([np.linspace(3.0, 7.0, 30), np.full(30, 5.34)])
    for robots, expected in (([], 5.34), (row, 4.66)):
        labels = LabelPlacement((10.0, 10.0))
        labels.clear(robots)
        _, y = labels.place(5.0, 5.0, 8)
        assert y - 0.2 == pytest.approx(expected)


def test_dashes_cover_half_of_the_line():
    broken = dashes((0.0, 0.0), (3.0, 4.0), 0.1)
    lengths = np.hypot(*(broken[:, 1] - broken[:, 0]).T)
    assert lengths.sum() == pytest.approx(2.5, rel=0.02)
    assert broken[0, 0] == pytest.approx([0.0, 0.0])
    assert dashes((1.0, 1.0), (1.0, 1.0), 0.1).shape == (1, 2, 2)


@given(st.integers(1, 10**9))
def test_ticks(size):
    some = ticks(size)
    assert 1 <= len(some) <= 6
    assert some[0] == 0
    assert some[-1] < size


def test_energy_grows_lighter():
    light = TABLE @ [0.2126, 0.7152, 0.0722]
    assert (np.diff(light) > 0.0).mean() > 0.98
    assert energy_colours([0.0, 100.0, 250.0, -3.0], 100.0).tolist() == [
        0x440154FF, 0xFDE725FF, 0xFDE725FF, 0x440154FF
    ]  # fmt: skip


def test_times_are_whole_nanoseconds():
    index = Index.of([Moment(0.1 + 0.2, 1, 2, 0.45), Moment(1125.05, 3, 4, 2000.0)])
    assert index.columns()[1].as_arrow_array().cast("int64").to_pylist() == [
        300_000_000, 1_125_050_000_000
    ]  # fmt: skip


def test_arrow_layouts_are_what_rerun_has():
    import rerun as rr

    assert pairs([(1, 2)]).type == rr.components.Position2DBatch([[1, 2]]).as_arrow_array().type
    strip = rr.components.LineStrip2DBatch([[[1, 2], [3, 4]]]).as_arrow_array()
    assert strips([[1, 2], [3, 4]], [2]).equals(strip)
    assert segments([[[1, 2], [3, 4]]]).equals(strip)
