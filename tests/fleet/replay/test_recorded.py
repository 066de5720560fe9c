"""What a recording says is what happened."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from itertools import pairwise
from math import dist

import numpy as np
import pytest

from fleet.replay import scheme
from fleet.replay.readback import Recording
from fleet.replay.rerun_recorder import RerunRecorder
from fleet.replay.scheme import LINK_PARTS, MSG, ROUND, SIM_TIME, TIMELINES
from protocols.messages import KINDS
from protocols.topology import edges
from worlds.arena import Arena
from worlds.shapes import Polygon

from .conftest import simulation

DECIMALS = 5  # positions are kept in single precision


def lines(recording, level):
    texts = recording.rows(scheme.LOG, "TextLog:text")
    levels = recording.rows(scheme.LOG, "TextLog:level")
    return [text[0] for text, of in zip(texts.values, levels.values, strict=True) if of == [level]]


def arrows(recording, path, timeline, moment):
    found = recording.at(path, "Arrows2D:origins", timeline, moment)
    return 0 if found is None else len(found)


@pytest.mark.parametrize("name", ["rounds", "stream"])
class TestBothWaysOfTime:
    @pytest.fixture(autouse=True)
    def _run(self, name, request):
        self.run = request.getfixturevalue(name)
        self.recording, self.witness = self.run.recording, self.run.witness

    def test_every_row_is_on_every_timeline(self):
        temporal = [chunk for chunk in self.recording.chunks if not chunk.is_static]
        assert len(temporal) > 20
        assert {tuple(sorted(chunk.timeline_names)) for chunk in temporal} == {
            tuple(sorted(TIMELINES))
        }

    def test_each_transmission_is_in_the_log(self):
        said = lines(self.recording, "TRACE")
        assert len(said) == len(self.witness.said) == self.run.summary.messages
        for line, sent in zip(said, self.witness.said, strict=True):
            number, *_ = line.split()
            assert int(number) == sent.number
            assert f" r{sent.transmission.sender} → " in line
            assert all(f"r{robot}" in line for robot in sent.heard[:8])

    def test_messages_are_counted_by_kind(self):
        rows = self.recording.rows(scheme.FLEET_MESSAGES, "Scalars:scalars").values
        counted = dict(zip(KINDS, np.sum(rows, axis=0).tolist(), strict=True))
        concluded = {event.id for event, *_ in self.witness.awards}
        told = Counter(
            sent.transmission.kind for sent in self.witness.said if sent.event in concluded
        )
        if len(concluded) == len(self.run.witness.raised):  # no conversation broke off
            assert counted == {kind: told[kind] for kind in KINDS}
        assert sum(counted.values()) >= sum(told.values())

    def test_robots_rest_where_their_trips_ended(self):
        places = self.witness.start.copy()
        for _, trip, _ in sorted(self.witness.trips, key=lambda of: of[1].ended):
            places[trip.robot] = trip.end
            recorded = self.recording.at(
                scheme.ROBOTS, "Points2D:positions", SIM_TIME, trip.ended + 1e-9
            )
            np.testing.assert_allclose(recorded[trip.robot], trip.end, atol=10**-DECIMALS)
            resting = ~np.isnan(recorded[:, 0])
            np.testing.assert_allclose(recorded[resting], places[resting], atol=10**-DECIMALS)

    def test_movers_are_where_they_were(self):
        samples = np.concatenate(self.witness.samples)
        assert len(samples) > 200
        for robot, time, x, y, *_ in samples[:: max(1, len(samples) // 97)].tolist():
            shown = self.recording.at(scheme.MOVERS, "Points2D:positions", SIM_TIME, time)
            if not any(
                trip.robot == robot and trip.ended == time for _, trip, _ in self.witness.trips
            ):
                assert np.abs(shown - [x, y]).sum(axis=1).min() < 10**-DECIMALS

    def test_energies_are_the_batteries(self):
        for (_, trip, _), energies in zip(self.witness.trips, self.witness.energies, strict=True):
            recorded = self.recording.at(scheme.ROBOTS, "Robot:energy", SIM_TIME, trip.ended)
            assert recorded[trip.robot] == pytest.approx(energies[trip.robot], abs=1e-4)

    @pytest.mark.parametrize(("path", "graph"), [(scheme.UDG, "udg"), (scheme.ROUTING, "gabriel")])
    def test_links_are_those_between_the_places_shown(self, path, graph):
        radio_range = self.recording.properties["scene"]["radio_range"]
        rows = self.recording.rows(f"{path}/moving", "LineStrips2D:strips")
        # In between, links are as old as the run's own.
        moments = np.intersect1d(rows.moments[SIM_TIME], sorted(self.witness.relinks))
        assert len(moments) > 30
        for moment in moments[:: max(1, len(moments) // 60)].tolist():
            at = moment / 1e9
            drawn = [
                strip
                for part in LINK_PARTS
                for strip in self.recording.at(
                    f"{path}/{part}", "LineStrips2D:strips", SIM_TIME, at
                )
            ]
            places = self.recording.at(scheme.ROBOTS, "Points2D:positions", SIM_TIME, at).astype(
                float
            )
            paint = self.recording.at(scheme.ROBOTS, "Points2D:colors", SIM_TIME, at)
            places[paint == scheme.DEAD_COLOUR] = np.nan
            movers = self.recording.at(scheme.MOVERS, "Points2D:positions", SIM_TIME, at)
            names = self.recording.at(scheme.MOVERS, "Points2D:labels", SIM_TIME, at)
            if movers is not None:
                for name, place in zip(names, movers, strict=True):
                    places[int(name[1:])] = place
            expected = {frozenset(pair) for pair in edges(places, radio_range, graph).tolist()}
            assert pairs_of(drawn, places) == expected

    def test_the_card_names_the_winner(self):
        named = 0
        for event, award, _, number in self.witness.awards:
            card = self.recording.at(scheme.CARD, "TextDocument:text", MSG, number)[0]
            if award.winner is not None and card.startswith(f"## Event {event.id + 1}:"):
                assert card.startswith(f"## Event {event.id + 1}: r{award.winner} goes")
                named += 1
        assert named > 5

    def test_decisions_are_apart_from_transmissions(self):
        decided = lines(self.recording, "INFO")
        raised = [line for line in decided if line.endswith(" is told")]
        assert len(raised) == len(self.witness.raised)
        assert sum(" wins: " in line for line in decided) == sum(
            award.winner is not None for _, award, *_ in self.witness.awards
        )


def pairs_of(strips, places):
    """Lines as unordered pairs of robots: those who are at their ends, within a millimetre."""
    ends = np.asarray(strips, float).reshape(-1, 2)
    away = np.hypot(*(ends[:, None, :] - np.nan_to_num(places, nan=1e9)[None]).transpose(2, 0, 1))
    assert not len(ends) or away.min(axis=1).max() < 1e-3
    return {frozenset(pair) for pair in away.argmin(axis=1).reshape(-1, 2).tolist()}


class TestRounds:
    def test_properties(self, rounds):
        properties = rounds.recording.properties
        assert rounds.recording.key == "test"
        assert properties["run"] == {"key": "test", "seed": 12, "nested_figure": 1.5}
        assert properties["summary"]["lifetime"] == rounds.summary.lifetime
        assert properties["scene"]["robots"] == 50
        assert "wall_time" not in properties["summary"]

    def test_each_hop_can_be_stepped_through(self, rounds):
        """At message k, the conversation up to k is drawn, and k itself stands out."""
        recording = rounds.recording
        starts = [number for *_, number in rounds.witness.raised] + [len(rounds.witness.said)]
        for first, last in pairwise(starts):
            drawn = Counter()
            for sent in rounds.witness.said[first:last]:
                drawn[sent.transmission.kind] += len(sent.heard)
                for kind in KINDS:
                    assert arrows(recording, scheme.messages(kind), MSG, sent.number) == drawn[kind]
                assert arrows(recording, scheme.PACKET, MSG, sent.number) == len(sent.heard)

    def test_greedy_and_face_hops_differ(self, rounds):
        assert rounds.summary.hops_face > 0
        assert rounds.summary.hops_greedy > 0
        greedy, face = scheme.messages("route-greedy"), scheme.messages("route-face")
        colours = [rounds.recording.static(p, "Arrows2D:colors").tolist() for p in (greedy, face)]
        assert colours[0] != colours[1]

    def test_arrows_lead_from_sender_to_receiver(self, rounds):
        places = rounds.witness.start
        for sent in rounds.witness.said[: rounds.witness.departures[0][3]]:
            origin = rounds.recording.at(scheme.PACKET, "Arrows2D:origins", MSG, sent.number)[0]
            vector = rounds.recording.at(scheme.PACKET, "Arrows2D:vectors", MSG, sent.number)[0]
            sender, receiver = places[sent.transmission.sender], places[sent.heard[0]]
            assert dist(origin, sender) < dist(origin, receiver)
            assert dist(origin + vector, receiver) < dist(origin + vector, sender)

    def test_at_the_last_message_the_winner_has_not_set_off_yet(self, rounds):
        places = rounds.witness.start.copy()
        for (_, robot, _, number), (_, trip, _) in zip(
            rounds.witness.departures, rounds.witness.trips, strict=True
        ):
            shown = rounds.recording.at(scheme.MOVERS, "Points2D:positions", MSG, number)
            np.testing.assert_allclose(shown, [places[robot]], atol=10**-DECIMALS)
            places[robot] = trip.end

    def test_rounds_show_how_they_ended(self, rounds):
        ends = {}
        for event, trip, _ in rounds.witness.trips:
            ends[event.id + 1] = trip
        for round_, trip in ends.items():
            places = rounds.recording.at(scheme.ROBOTS, "Points2D:positions", ROUND, round_)
            np.testing.assert_allclose(places[trip.robot], trip.end, atol=10**-DECIMALS)

    def test_predicted_and_drained_energy(self, rounds):
        rows = rounds.recording.rows(scheme.TOTAL_ENERGY, "Scalars:scalars").values
        assert rows[-1].tolist() == pytest.approx(
            [rounds.summary.energy_predicted, sum(t.energy for _, t, _ in rounds.witness.trips)]
        )

    def test_energy_curves(self, rounds):
        rows = rounds.recording.rows(scheme.FLEET_ENERGY, "Scalars:scalars").values
        for row, energies in zip(rows[1:], rounds.witness.energies, strict=True):
            mean, spread = np.mean(energies), np.std(energies)
            assert row.tolist() == pytest.approx(
                [mean, min(energies), max(mean - spread, 0.0), mean + spread]
            )

    def test_links_and_components_are_counted(self, rounds):
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import connected_components

        places = rounds.witness.start.copy()
        links = rounds.recording.rows(scheme.LINK_COUNT, "Scalars:scalars").values
        pieces = rounds.recording.rows(scheme.COMPONENTS, "Scalars:scalars").values
        for k, ((_, trip, _), energies) in enumerate(
            zip(rounds.witness.trips, rounds.witness.energies, strict=True), 1
        ):
            places[trip.robot] = trip.end
            on_air = np.array(energies) > 0.0
            known = np.where(on_air[:, None], places, np.nan)
            udg, routing = edges(known, 3.0, "udg"), edges(known, 3.0, "gabriel")
            assert links[k].tolist() == [len(udg), len(routing)]
            graph = coo_array((np.ones(len(routing)), routing.T), shape=(len(places),) * 2)
            count, _ = connected_components(graph, directed=False)
            assert pieces[k].tolist() == [count - (~on_air).sum()]

    def test_the_dead_are_marked(self, rounds):
        assert any(silent for *_, silent in rounds.witness.silent)
        for time, places, silent in rounds.witness.silent:
            crosses = rounds.recording.at(scheme.MARKS, "LineStrips2D:strips", SIM_TIME, time)
            middles = np.mean(np.array(crosses or np.empty((0, 2, 2))), axis=1)
            assert len(middles) == 2 * len(silent)  # strokes
            if silent:
                found = {tuple(np.round(m.astype(float), 2).tolist()) for m in middles}
                assert found == {tuple(np.round(places[r], 2).tolist()) for r in silent}

    def test_the_energy_map_has_every_robot_and_round(self, rounds):
        import io

        from PIL import Image

        blob = rounds.recording.static(scheme.ENERGY_MAP, "EncodedImage:blob")
        image = np.array(Image.open(io.BytesIO(blob[0].tobytes())))
        served = {event.id + 1 for event, *_ in rounds.witness.trips}
        assert image.shape == (50, max(served) + 1)
        last = {}
        for (event, _, _), energies in zip(
            rounds.witness.trips, rounds.witness.energies, strict=True
        ):
            last[event.id + 1] = energies
        for round_, energies in last.items():
            expected = np.rint(255 * np.clip(np.array(energies) / 60.0, 0, 1))
            np.testing.assert_array_equal(image[:, round_], expected)

    def test_the_chart_has_an_arrow_for_each_reception(self, rounds):
        for (_, _, _, first), (_, _, _, last) in zip(
            rounds.witness.raised[:9], rounds.witness.awards[:9], strict=True
        ):
            lines = rounds.witness.said[first:last]
            number = lines[0].number
            origins = rounds.recording.at(scheme.CHART_MESSAGES, "Arrows2D:origins", MSG, number)
            names = rounds.recording.at(scheme.CHART_ROBOTS, "Points2D:labels", MSG, number)
            assert len(origins) == sum(len(line.heard) for line in lines)
            took_part = {line.transmission.sender for line in lines} | {
                robot for line in lines for robot in line.heard
            }
            assert len(names) == len(took_part)
            rows = [
                rounds.recording.at(scheme.CHART_CURSOR, "LineStrips2D:strips", MSG, line.number)
                for line in lines
            ]
            heights = [row[0][0, 1] for row in rows]
            assert heights == sorted(set(heights))


def test_obstacles_and_their_outlines(tmp_path):
    blocks = (
        Polygon(((1.0, 1.0), (3.0, 1.0), (3.0, 2.0), (1.0, 2.0))),
        Polygon(((7.0, 7.0), (8.0, 8.0), (6.0, 9.0))),
    )
    watching = RerunRecorder(tmp_path / "run.rrd", key="k", properties={}, strict=True)
    prepared = simulation([watching], rounds=1)
    prepared.fleet = replace(prepared.fleet, arena=Arena(12.0, 10.0, obstacles=blocks))
    prepared.run()
    recording = Recording(tmp_path / "run.rrd")
    outlines = recording.static(scheme.OBSTACLES, "LineStrips2D:strips")
    assert [len(outline) for outline in outlines] == [5, 4]
    assert outlines[0][0].tolist() == [1.0, 1.0]
    assert recording.static(scheme.HOLE, "LineStrips2D:strips") is None
    walls = recording.static(scheme.WALLS, "LineStrips2D:strips")[0]
    assert walls.max(axis=0).tolist() == [12.0, 10.0]


class TestStream:
    def test_several_are_under_way_at_once(self, stream):
        rows = stream.recording.rows(scheme.MOVERS, "Points2D:positions").values
        assert max(map(len, rows)) >= 2

    def test_lost_frames_are_drawn_as_lost(self, stream):
        lost = [sent for sent in stream.witness.said if not sent.heard]
        assert lost
        drawn = sum(arrows(stream.recording, scheme.LOST, MSG, sent.number) > 0 for sent in lost)
        assert drawn > len(lost) / 3  # those about the event in focus
        assert sum("lost" in line for line in lines(stream.recording, "TRACE")) == sum(
            sent.transmission.receiver is not None for sent in lost
        )

    def test_retries_are_told(self, stream):
        again = [sent for sent in stream.witness.said if sent.attempts > 1]
        assert again
        told = [line for line in lines(stream.recording, "TRACE") if "×" in line]
        assert len(told) == len(again)

    def test_open_events_stay_on_the_map(self, stream):
        for event, _, time, _ in stream.witness.raised:
            shown = [
                stream.recording.at(path, "Points2D:positions", SIM_TIME, time)
                for path in (scheme.EVENT, scheme.OPEN_EVENTS)
            ]
            places = np.concatenate([row for row in shown if row is not None])
            assert np.abs(places - event.position).sum(axis=1).min() < 10**-DECIMALS

    @pytest.mark.parametrize("path", [scheme.EVENT, scheme.SEARCH])
    def test_only_the_event_in_focus_has_its_circle(self, stream, path):
        for *_, time, _ in stream.witness.raised:
            sites = stream.recording.at(scheme.EVENT, "Points2D:positions", SIM_TIME, time)
            centres = stream.recording.at(path, "Ellipses2D:centers", SIM_TIME, time)
            sizes = stream.recording.at(path, "Ellipses2D:half_sizes", SIM_TIME, time)
            assert centres.tolist() == sites.tolist()
            assert len(sizes) == len(sites) == 1


@pytest.mark.parametrize("protocol", ["rfta3", "assignment"])
def test_events_that_expire_while_they_are_talked_over(protocol, tmp_path):
    time = {"name": "stream", "rate": 1.0, "duration": 40.0, "deadline": 0.1}
    settings = {"protocol": protocol, "time": time, "radio": {"name": "lossy", "loss": 0.2}}
    watching = RerunRecorder(tmp_path / "run.rrd", key="k", properties={}, strict=True)
    summary = simulation([watching], robots=60, **settings).run()
    assert summary.expired > 0
    assert Recording(tmp_path / "run.rrd").properties["summary"]["events"] == summary.events
