"""The real viewer, without a window: it opens recordings, no view complains, and it shows them."""

from __future__ import annotations

import time
from collections import Counter

import numpy as np
import pytest

from fleet.observer import Observer
from fleet.replay import scheme
from fleet.replay.comparison import arrange
from fleet.replay.headless import HeadlessViewer, NoViewer
from fleet.replay.readback import Recording
from fleet.replay.rerun_recorder import RerunRecorder

from .conftest import simulation

pytestmark = pytest.mark.slow  # a viewer that draws in software takes its time

REPLAY = {"Event", "Decisions", "Sequence chart"}
LIFETIME = {
    "Energy of each robot, round by round", "Where robots went", "Robots by energy left [J]",
    "Energy of a robot [J]", "Energy of all trips so far [J]", "Messages an event", "Links",
    "Connected components", "Robots on the air",
}  # fmt: skip


@pytest.fixture(scope="module")
def viewer():
    try:
        viewer = HeadlessViewer(1400, 800)
    except NoViewer as reason:
        pytest.skip(f"the viewer does not start here: {reason}")
    with viewer:
        yield viewer


def floor(viewer):
    """The view of the floor, whose name says which run it is."""
    return next(view.name for view in viewer.state().views if view.name.startswith("rfta2 · "))


def painted(image, colour, tolerance=14):
    rgb = [colour >> shift & 255 for shift in (24, 16, 8)]
    return int((np.abs(np.array(image).astype(int) - rgb).max(axis=2) <= tolerance).sum())


def shows(viewer, names):
    """Whether each of the views is in sight, with something in it."""
    return all(len(np.unique(np.array(viewer.picture(name)))) > 8 for name in names)


def test_hops_calls_and_bids_are_seen_one_by_one(viewer, rounds):
    viewer.open(rounds.path)
    assert {line.name for line in viewer.state().recordings[0].timelines} == set(scheme.TIMELINES)
    face = [s for s in rounds.witness.said if s.transmission.kind == "route-face"]
    event, _ = Counter(sent.event for sent in face).most_common(1)[0]
    numbers = [sent.number for sent in face if sent.event == event]
    viewer.go("msg", sequence=numbers[0] - 1)
    before = viewer.picture(floor(viewer))
    viewer.go("msg", sequence=numbers[-1] + 1)
    after = viewer.picture(floor(viewer))
    orange, blue = (scheme.KIND_COLOURS[kind] for kind in ("route-face", "route-greedy"))
    assert painted(before, orange) < 20 < 100 < painted(after, orange)
    assert painted(after, blue) > 30
    viewer.go("msg", sequence=max(s.number for s in rounds.witness.said if s.event == event))
    assert shows(viewer, REPLAY | {floor(viewer)})
    assert viewer.problems() == []


def test_a_mover_leaves_its_place_and_arrives(viewer, rounds):
    viewer.open(rounds.path)
    _, trip, _ = max(rounds.witness.trips, key=lambda of: of[1].path)
    pictures = []
    for share in (0.3, 0.8):
        viewer.go("sim_time", duration=trip.departed + share * (trip.ended - trip.departed))
        pictures.append(np.array(viewer.picture(floor(viewer))).astype(int))
    assert (np.abs(pictures[0] - pictures[1]).max(axis=2) > 40).sum() > 100
    assert painted(pictures[1], scheme.WINNER_COLOUR) > painted(pictures[0], scheme.WINNER_COLOUR)
    assert viewer.problems() == []


def test_the_lifetime(viewer, rounds):
    viewer.open(rounds.path)
    viewer.front("Lifetime")
    viewer.go("round", sequence=10)
    assert shows(viewer, LIFETIME)
    energy = viewer.picture("Energy of each robot, round by round")
    assert painted(energy, 0xFDE725FF) > 0.03 * energy.width * energy.height
    assert viewer.problems() == []


@pytest.mark.parametrize("name", ["How to read", "Transmissions", "Messages an event", "Trip [J]"])
def test_tabs_behind(viewer, rounds, name):
    viewer.open(rounds.path)
    viewer.front("Replay")
    viewer.front(name)
    viewer.go("round", sequence=5)
    picture = np.array(viewer.picture(name))
    assert len(np.unique(picture.reshape(-1, 3), axis=0)) > 20
    assert viewer.problems() == []


def test_a_stream_with_losses(viewer, stream):
    viewer.open(stream.path)
    lost = next(sent for sent in stream.witness.said if not sent.heard)
    viewer.go("msg", sequence=lost.number + 1)
    for tab in REPLAY:  # they may have been sent behind
        viewer.front(tab)
    viewer.settle()
    assert shows(viewer, REPLAY | {floor(viewer)})
    viewer.picture(floor(viewer))
    assert viewer.problems() == []


def test_two_runs_side_by_side(viewer, rounds, stream, tmp_path):
    arrange([rounds.path, stream.path], tmp_path / "both.rrd")
    viewer.open(tmp_path / "both.rrd")
    viewer.go("round", sequence=6)
    names = {view.name for view in viewer.state().views}
    worlds = [name for name in names if name.startswith("rfta2 · ")]
    assert len(worlds) == 2
    for name in worlds:
        assert painted(viewer.picture(name), scheme.EVENT_COLOUR, 30) > 20
    assert viewer.problems() == []


class ClosesTheWindow(Observer):
    """Ends a viewer in the middle of a run, when the file has been begun."""

    def __init__(self, viewer, path):
        self.viewer, self.path, self.trips = viewer, path, 0

    def trip_ended(self, event, trip):
        self.trips += 1
        if self.trips == 5:
            while not (self.path.exists() and self.path.stat().st_size):
                time.sleep(0.05)
            self.viewer.close()


def test_the_file_is_complete_if_the_live_viewer_is_closed(tmp_path):
    path = tmp_path / "live.rrd"
    try:
        other = HeadlessViewer(400, 300)
    except NoViewer as reason:
        pytest.skip(f"the viewer does not start here: {reason}")
    watching = RerunRecorder(path, key="k", properties={}, live=other.url, strict=True)
    simulation([ClosesTheWindow(other, path), watching], rounds=12).run()
    assert Recording(path).span(scheme.ROUND) == (0.0, 12.0)


def test_no_viewer_listens(tmp_path):
    with pytest.raises(RuntimeError, match="no viewer listens at"):
        simulation(
            [RerunRecorder(None, key="k", properties={}, live="rerun+http://127.0.0.1:9/proxy")],
            rounds=3,
        ).run()


def test_live_and_into_a_file_at_once(viewer, tmp_path):
    path = tmp_path / "live.rrd"
    watching = RerunRecorder(path, key="live-run", properties={}, live=viewer.url, strict=True)
    summary = simulation([watching], rounds=5).run()
    deadline = time.monotonic() + 20.0
    while time.monotonic() < deadline:
        found = [r for r in viewer.state().recordings if "live-run" in str(r.store_id)]
        if found and {t.name for t in found[0].timelines} >= set(scheme.TIMELINES):
            break
        time.sleep(0.1)
    else:
        pytest.fail("the run did not appear in the viewer")
    rounds_seen = next(t for t in found[0].timelines if t.name == "round")
    assert rounds_seen.end == 5
    assert Recording(path).properties["summary"]["lifetime"] == summary.lifetime == 5
    assert viewer.problems() == []


def test_live_and_from_the_file_look_the_same(viewer, tmp_path):
    path = tmp_path / "run.rrd"
    simulation([RerunRecorder(path, key="from-file", properties={})], rounds=8).run()
    viewer.open(path)
    viewer.front("Event")  # a test before may have sent it behind
    viewer.go("round", sequence=6)
    expected = [np.array(viewer.picture(name)) for name in (floor(viewer), "Event")]
    live = RerunRecorder(None, key="live-again", properties={}, live=viewer.url, flush_rounds=1)
    simulation([live], rounds=8).run()
    deadline = time.monotonic() + 20.0
    while time.monotonic() < deadline:
        found = [r for r in viewer.state().recordings if "live-again" in str(r.store_id)]
        if found and any(t.name == "round" and t.end == 8 for t in found[0].timelines):
            break
        time.sleep(0.1)
    viewer.front("Event")
    viewer.go("round", sequence=6)
    assert "live-again" in str(viewer.state().active_recording)
    shown = [np.array(viewer.picture(name)) for name in (floor(viewer), "Event")]
    for one, other in zip(shown, expected, strict=True):
        assert (np.abs(one.astype(int) - other) > 24).any(axis=2).mean() < 1e-3
