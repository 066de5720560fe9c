"""What is drawn and said of a run is what the run knew: faults, links, words, names, tables."""

from __future__ import annotations

import re
from math import dist

import numpy as np
import pytest

import fleet
from fleet.observer import Observer
from fleet.replay import scheme
from fleet.replay.layers.card_words import BELIEFS
from fleet.replay.readback import Recording
from fleet.replay.rerun_recorder import RerunRecorder
from fleet.replay.scheme import LINK_PARTS, SIM_TIME, STORY, TIMELINES
from protocols.catalogue import METRICS, PROTOCOLS

SAMPLE = 0.05  # [s]
FAULTY = {
    "faults": {
        "planned": [
            {"time": 5.0, "robot": 2, "what": "motor"}, {"time": 9.0, "robot": 3, "what": "all"}
        ],
        "blackouts": [{"start": 12.0, "duration": 4.0, "x": 4.0, "y": 4.0, "radius": 3.0}],
    },
    "time": {"name": "stream", "rate": 0.3, "duration": 30.0},
}  # fmt: skip


class Witness(Observer):
    """Keeps what the run told."""

    def __init__(self):
        self.lines, self.beliefs, self.awards, self.trips = [], {}, {}, []
        self.air, self.faults = [], []

    def run_started(self, fleet):
        self.fleet = fleet

    def transmitted(self, excerpt):
        self.lines += excerpt.lines()

    def appraised(self, event, appraisals, time):
        self.beliefs[event.id] = {a.robot: a for a in appraisals}

    def awarded(self, event, award, time):
        self.awards[event.id] = award

    def trip_ended(self, event, trip):
        self.trips.append((event, trip))

    def broke_down(self, fault):
        self.faults.append(
            (fault.time, fault.robot, "motor" if fault.what == "motor" else "broken")
        )

    def air_changed(self, on_air, time):
        self.air.append((time, frozenset(on_air)))


def recorded(path, **settings):
    settings = {"motion": "straight", "robots": 40, "range": 3.0, "seed": 4, **settings}
    witness = Witness()
    recorder = RerunRecorder(path, key="k", properties={}, strict=True)
    fleet.run(fleet.Scenario.of(**settings), [witness, recorder])
    return Recording(path), witness


@pytest.fixture(scope="module")
def faulty(tmp_path_factory):
    return recorded(tmp_path_factory.mktemp("faulty") / "run.rrd", **FAULTY)


def marks(recording, timeline, moment):
    """Middles of the strokes by their colour."""
    strips = recording.at(scheme.MARKS, "LineStrips2D:strips", timeline, moment)
    paint = recording.at(scheme.MARKS, "LineStrips2D:colors", timeline, moment)
    found = {}
    for strip, colour in zip(
        [] if strips is None else strips, [] if paint is None else paint, strict=True
    ):
        found.setdefault(int(colour), []).append(np.mean(strip, axis=0))
    return found


def moments_of(recording, time):
    """The same moment on each timeline: that of the first row then."""
    rows = recording.rows(scheme.MARKS, "LineStrips2D:strips")
    row = int(np.flatnonzero(rows.moments[SIM_TIME] == round(1e9 * time))[-1])
    for timeline in TIMELINES:
        moment = rows.moments[timeline][row]
        yield timeline, moment / 1e9 if timeline in scheme.IN_SECONDS else float(moment)


def test_each_fault_is_seen_within_a_sample_on_every_timeline(faulty):
    recording, witness = faulty
    assert len(witness.faults) == 2
    for time, robot, why in witness.faults:
        place = witness.fleet.robots[robot].position
        for timeline, moment in moments_of(recording, time):
            found = marks(recording, timeline, moment).get(scheme.MARK_COLOURS[why], [])
            assert any(dist(middle, place) < 1e-3 for middle in found), (why, timeline)
        before = marks(recording, SIM_TIME, time - SAMPLE)
        assert scheme.MARK_COLOURS[why] not in before


def test_silence_and_its_end_are_seen(faulty):
    recording, witness = faulty
    colour = scheme.MARK_COLOURS["silenced"]
    assert any(time == 12.0 for time, _ in witness.air)
    for start, silent in ((12.0, True), (16.0, False)):
        for timeline, moment in moments_of(recording, start):
            circles = recording.at(scheme.SILENT, "Ellipses2D:centers", timeline, moment)
            if timeline in scheme.IN_SECONDS:
                assert (colour in marks(recording, timeline, moment)) == silent
                assert len(circles) == silent
    lines = [text[0] for text in recording.rows(scheme.LOG, "TextLog:text").values]
    assert "radio silence within 3 m of (4, 4) m" in lines
    assert "radio silence is over within 3 m of (4, 4) m" in lines
    assert "r2 is motor broken" in lines
    assert "r3 is broken down" in lines


TIME = {"name": "stream", "rate": 1.0, "duration": 25.0}
RADIOS = [
    {},
    {"radio": {"name": "lossy", "loss": 0.2}, "time": TIME},
    {"radio": {"name": "lossy", "shadowing": 6.0}, "time": TIME},
    {"graph": "udg"},
    {"graph": "rng"},
]


@pytest.mark.parametrize("radio", RADIOS, ids=["ideal", "lossy", "shadowed", "udg", "rng"])
def test_every_reception_is_on_a_drawn_link(radio, tmp_path):
    settings = radio if "time" in radio else {**radio, "rounds": 12}
    recording, witness = recorded(tmp_path / "run.rrd", **settings)
    checked = 0
    for line in witness.lines[:: max(1, len(witness.lines) // 80)]:
        ends = set()
        for path in (scheme.UDG, scheme.ROUTING):
            for part in LINK_PARTS:
                found = recording.at(
                    f"{path}/{part}", "LineStrips2D:strips", scheme.MSG, line.number
                )
                ends |= {tuple(np.round(end, 4).ravel().tolist()) for end in found or ()}
        places = recording.at(scheme.ROBOTS, "Points2D:positions", scheme.MSG, line.number)
        for robot in line.heard:
            pair = places[[line.transmission.sender, robot]]
            if np.isnan(pair).any():
                continue  # one is under way
            drawn = {tuple(np.round(p, 4).ravel().tolist()) for p in (pair, pair[::-1])}
            assert ends & drawn, line
            checked += 1
    assert checked > 30


def headings(card):
    return card.partition("\n")[0]


@pytest.mark.parametrize("protocol", sorted(PROTOCOLS))
def test_every_sentence_of_the_card_is_true(protocol, tmp_path):
    check_cards(tmp_path, protocol=protocol, rounds=6)


@pytest.mark.parametrize("belief", sorted(BELIEFS))
def test_the_card_says_what_was_believed(belief, tmp_path):
    motion = {"name": "path", "belief": belief}
    if belief == "corrected":
        motion |= {"per_metre": 10.0, "per_launch": 2.0}
    check_cards(tmp_path, protocol="rfta2", motion=motion, rounds=6, belief=belief)


def check_cards(tmp_path, *, protocol, belief="straight", **settings):
    recording, witness = recorded(tmp_path / "run.rrd", protocol=protocol, **settings)
    rows = recording.rows(scheme.CARD, "TextDocument:text")
    cards = [text[0] for text in rows.values]
    scene = recording.properties["scene"]
    checked = 0
    for event, award in witness.awards.items():
        titles = [card for card in cards if card.startswith(f"## Event {event + 1}")]
        told = next((c for c in titles if re.match(r"## Event \d+: (r\d+ goes|nobody)", c)), None)
        if told is None:
            assert award.moves, (protocol, titles)
            continue
        lines = [line for line in witness.lines if line.event == event]
        check_search(told, lines, award, witness)
        check_asked(told, lines, award)
        check_bids(told, award, witness.beliefs[event], scene)
        if award.winner is not None and award.winner in witness.beliefs[event]:
            held = witness.beliefs[event][award.winner]
            assert (
                f"**r{award.winner}** believed that it takes **{held.cost:.1f} J**"
                f" ({BELIEFS[belief]}) of the {held.energy:.1f} J that it held" in told
            )
        checked += 1
    assert checked >= 3
    for event, trip in witness.trips:
        came = [c for c in cards if f"| driven | {trip.path:.2f} m | **{trip.energy:.1f} J**" in c]
        assert any(c.startswith(f"## Event {event.id + 1}:") for c in came)


def check_search(card, lines, award, witness):
    hops = [line.transmission.kind for line in lines if "route" in line.transmission.kind]
    found = re.search(r"took \*\*(\d+) hops?\*\* \((.*?)\) and ended at \*\*r(\d+)\*\*", card)
    if hops:
        assert int(found[1]) == len(hops)
        face = hops.count("route-face")
        greedy = len(hops) - face
        assert found[2] == (f"{greedy} greedy, {face} face" if face else "all greedy")
        assert int(found[3]) == award.auctioneer
    else:
        assert found is None
        assert "no hops" in card or "no search" in card or "decides" in card


def check_asked(card, lines, award):
    """Whoever heard a call first, over as many hops as it took."""
    hops = {}
    for line in lines:
        if line.transmission.kind == "call":
            for robot in line.heard:
                if robot != award.auctioneer:
                    hops.setdefault(robot, hops.get(line.transmission.sender, 0) + 1)
    found = re.search(r"\*\*r\d+\*\* asked ([^:]*):", card)
    if found is None:
        assert not hops
        assert "Nobody was asked." in card
        return
    counts = {}
    for number, far in re.findall(r"(\d+) (neighbours?|\d+ hops away)", found[1]):
        counts[1 if far.startswith("n") else int(far.split()[0])] = int(number)
    assert sum(counts.values()) == len(hops)
    if "iterated" not in card:
        assert counts[min(counts)] <= len(hops)


def check_bids(card, award, beliefs, scene):
    if not award.bids:
        return
    unit = f" [{scene['unit']}]" if scene.get("unit") else ""
    assert f"| {scene['metric'] or 'bid'}{unit} | believed | holds |" in card
    assert not scene["metric"] or METRICS[scene["metric"]].unit == scene.get("unit", "")
    rows = re.findall(
        r"\| (?:\*\*)?r(\d+)(?:\*\* goes)? \| (-?[\d.]+|inf) \| (.*?) \| (.*?) \|", card
    )
    assert [int(row[0]) for row in rows] == [bid.robot for bid in sorted(award.bids)[:5]]
    for (robot, cost, believed, holds), bid in zip(rows, sorted(award.bids), strict=False):
        assert float(cost) == pytest.approx(bid.cost, abs=0.006)
        mine = beliefs[int(robot)]
        assert believed == f"{mine.cost:.1f} J"
        assert holds == f"{mine.energy:.1f} J"
    for robot, cost, energy in re.findall(r"r(\d+): believes ([\d.]+) J, holds ([\d.]+) J", card):
        mine = beliefs[int(robot)]
        assert mine.cost > mine.energy
        assert (cost, energy) == (f"{mine.cost:.1f}", f"{mine.energy:.1f}")


@pytest.mark.parametrize("name", ["rounds", "stream"])
def test_no_name_without_what_it_names(name, request):
    recording = request.getfixturevalue(name).recording
    rng = np.random.default_rng(1)
    for timeline in (STORY, SIM_TIME):
        first, last = recording.span(timeline)
        for moment in (first + (last - first) * rng.random(100)).tolist():
            check_names(recording, timeline, moment)


def check_names(recording, timeline, moment):
    words = recording.at(scheme.NAMES, "Points2D:labels", timeline, moment)
    if words is None:
        return
    events = recording.at(scheme.EVENT, "Points2D:positions", timeline, moment)
    robots = recording.at(scheme.ROBOTS, "Points2D:positions", timeline, moment)
    card = recording.at(scheme.CARD, "TextDocument:text", timeline, moment)[0]
    for word in words:
        if word.startswith("event"):
            assert len(events) == 1
            assert headings(card).startswith(f"## Event {word.split()[1]}")
        else:
            assert not np.isnan(robots[int(word.rpartition(" r")[2])]).any()
    assert len(events) == any(word.startswith("event") for word in words)


@pytest.mark.parametrize("name", ["rounds", "stream"])
class TestTables:
    @pytest.fixture(autouse=True)
    def _run(self, name, request):
        self.run = request.getfixturevalue(name)

    def table(self, path):
        return self.run.recording.table(path)

    def test_the_transcript(self):
        rows = self.run.recording.table(scheme.TRANSCRIPT).to_pylist()
        said = self.run.witness.said
        assert len(rows) == len(said)
        for row, line in zip(rows, said, strict=True):
            sent = line.transmission
            assert row["number"] == line.number
            assert row["time"] == line.time
            assert row["event"] == line.event + 1
            assert (row["kind"], row["sender"]) == (sent.kind, sent.sender)
            assert row["receiver"] == (-1 if sent.receiver is None else sent.receiver)
            assert tuple(row["heard"]) == line.heard
            assert row["attempts"] == line.attempts
            if sent.bid is None:
                assert row["bidder"] == -1
                assert row["cost"] is None
            else:
                assert (row["bidder"], row["cost"]) == (sent.bid.robot, sent.bid.cost)
                assert row["metric"] == "energy-left"

    def test_the_trips(self):
        rows = self.run.recording.table(scheme.TRIPS).to_pylist()
        trips = [(event, trip) for event, trip, _ in self.run.witness.trips]
        assert len(rows) == len(trips)
        for row, (event, trip) in zip(rows, trips, strict=True):
            assert (row["event"], row["robot"]) == (event.id + 1, trip.robot)
            assert (row["outcome"], row["ended"]) == (trip.outcome, trip.ended)
            assert (row["energy"], row["path"]) == (trip.energy, trip.path)
            assert (row["to_x"], row["to_y"]) == trip.site

    def test_the_tasks(self):
        rows = self.run.recording.table(scheme.TASKS).to_pylist()
        assert sorted(row["event"] for row in rows) == [*range(1, self.run.summary.events + 1)]
        outcomes = {row["event"]: row["outcome"] for row in rows}
        for event, outcome, _ in self.run.witness.over:
            assert outcomes[event.id + 1] == outcome
        assert sum(row["outcome"] == "served" for row in rows) == self.run.summary.served
        offers = [event.id + 1 for event, *_ in self.run.witness.raised]
        assert all(row["offers"] == offers.count(row["event"]) for row in rows)


def test_the_story_lets_everything_be_seen(rounds, stream):
    for run in (rounds, stream):
        rows = run.recording.rows(scheme.TRANSCRIPT, "transcript:number")
        stories, times = rows.moments[STORY] / 1e9, rows.moments[SIM_TIME] / 1e9
        gaps = np.diff(stories)
        assert gaps.min() >= scheme.BEAT - 1e-9
        assert (np.diff(stories - times) >= -1e-6).all()  # it only falls behind
        poses = run.recording.rows(scheme.MOVERS, "Robot:id")
        drive, story = np.diff(poses.moments[SIM_TIME]), np.diff(poses.moments[STORY])
        assert np.median((story / np.maximum(drive, 1))[drive > 0]) == pytest.approx(1.0, abs=1e-6)


def test_a_run_that_broke_off_says_so(tmp_path):
    class Stops(Observer):
        def awarded(self, event, award, time):
            if event.id == 4:
                raise KeyboardInterrupt

    recorder = RerunRecorder(tmp_path / "run.rrd", key="k", properties={})
    scenario = fleet.Scenario.of(motion="straight", robots=30, range=4.0, rounds=9)
    with pytest.raises(KeyboardInterrupt):
        fleet.run(scenario, [Stops(), recorder])
    recording = Recording(tmp_path / "run.rrd")
    time = recording.span(SIM_TIME)[1]
    card = recording.at(scheme.CARD, "TextDocument:text", SIM_TIME, time)[0]
    assert headings(card) == f"## The run broke off at {time:.2f} s"
    lines = [text[0] for text in recording.rows(scheme.LOG, "TextLog:text").values]
    assert f"the run broke off at {time:.2f} s" in lines


def test_who_is_pointed_at_says_who_it_is(faulty):
    """The viewer shows up to three components that differ from robot to robot."""
    recording, witness = faulty
    for path in (scheme.PARTS, scheme.ROBOTS):
        differ = {
            name
            for batch in recording.batches(path)
            for name in batch.schema.names
            if ":" in name and any(len(cell.values) > 1 for cell in batch.column(name) if cell)
        }
        assert len(differ) <= 3, path
    checked = 0
    for line in witness.lines:
        words = recording.at(scheme.PARTS, f"Robot:{scheme.ROBOT_IS}", scheme.MSG, line.number)
        places = recording.at(scheme.PARTS, "Points2D:positions", scheme.MSG, line.number)
        paint = recording.at(scheme.PARTS, "Points2D:colors", scheme.MSG, line.number)
        robots = recording.at(scheme.ROBOTS, "Points2D:positions", scheme.MSG, line.number)
        colours = recording.at(scheme.ROBOTS, "Points2D:colors", scheme.MSG, line.number)
        for text, place, colour in zip(words[1:], places[1:], paint[1:], strict=True):
            told = re.fullmatch(r"robot (\d+) · \d+ J · ([a-z, ]+) of event (\d+)", text)
            robot = int(told[1])
            if not np.isnan(robots[robot]).any():
                assert dist(place, robots[robot]) < 1e-4
                assert colour == colours[robot]  # it hides nothing
            if "auctioneer" in told[2] and (award := witness.awards.get(int(told[3]) - 1)):
                assert award.auctioneer == robot
                checked += 1
    assert checked > 10
