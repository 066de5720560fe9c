"""What a robot does not remember, and where a packet that went in circles goes on."""

from __future__ import annotations

import pytest

from fleet import Scenario, run
from fleet.radio import tables

CIRCLES = """
from pathlib import Path
from protocols.messages import Award, Transmission

STARTS = Path(__file__).with_name("starts.txt")


def note(line):
    with STARTS.open("a") as file:
        file.write(line + "\\n")


def mine(view, event, source):
    here, told = source, [source]
    if len(view) > 2:
        note(f"from {source}")
    while len(view) > 2:
        for ahead in sorted(view[here].neighbours, key=lambda robot: (robot in told, robot)):
            note(f"to {ahead}")
            if (yield Transmission("route-face", here, ahead)):
                here = ahead
                told.append(here)
                break
    yield from ()
    return Award(None, source)
"""


def test_a_full_table_drops_what_is_oldest():
    heard = tables.nothing_heard(4, 2, 10.0, mutual=False)
    for other, time in ((1, 2.0), (2, 1.0), (3, 3.0)):
        tables.note(heard, 0, other, 0.5 * other, 0.0, time)
    kept = heard.known[0, : heard.size[0]].tolist()
    assert sorted(kept) == [1, 3]
    assert sorted(heard.x[0, :2].tolist()) == [0.5, 1.5]


def test_a_packet_that_went_in_circles_starts_anew_from_where_it_stands(tmp_path):
    file = tmp_path / "circles.py"
    file.write_text(CIRCLES)
    settings = {"motion": "straight", "robots": 9, "range": 6.0, "rounds": 1, "seed": 2}
    run(Scenario.of(protocol=f"{file}:mine", radio={"name": "lossy"}, **settings))
    lines = (tmp_path / "starts.txt").read_text().splitlines()
    starts = [k for k, line in enumerate(lines) if line.startswith("from")]
    for k in starts[1:4]:  # it begins anew three times, and is given up
        assert lines[k].removeprefix("from ") == lines[k - 1].removeprefix("to ")
    assert starts[1] - starts[0] == 10 * 9 + 2, "after ten hops for each robot, and one"


@pytest.mark.slow
@pytest.mark.parametrize("protocol", ["gfgf1", "rfta2"])
def test_shadowed_links_do_not_lead_a_search_astray(protocol):
    """Nobody is lost up to 6 dB on 20 networks, with at most three times the frames of a disc."""
    frames = {}
    for deviation in (0.0, 4.0, 6.0):
        frames[deviation] = 0
        for seed in range(20):
            radio = {"name": "lossy", "shadowing": deviation}
            settings = {"motion": "straight", "rounds": 5, "robot": {"capacity": 1e5}}
            summary = run(Scenario.of(protocol=protocol, seed=seed, radio=radio, **settings))
            assert summary.served == summary.events == 5
            frames[deviation] += summary.messages
    assert max(frames.values()) <= 3 * frames[0.0]
