"""Clips go through what happened in order, and say why if they cannot."""

from __future__ import annotations

import itertools
import shutil
import subprocess
from itertools import pairwise

import numpy as np
import pytest
from PIL import Image

from fleet.replay.clip import clip, frames
from fleet.replay.scheme import MSG, ROUND, SIM_TIME


def frames_of(rounds, start, stop, step=0.1):
    return frames(rounds.recording, start, stop, step)


def test_a_round_is_its_transmissions_and_then_its_drive(rounds):
    round_ = 7
    found = frames_of(rounds, {"round": round_}, {"round": round_})
    said = [sent for sent in rounds.witness.said if sent.event == round_ - 1]
    (trip,) = [trip for event, trip, _ in rounds.witness.trips if event.id == round_ - 1]
    assert found[: len(said)] == [(MSG, sent.number) for sent in said]
    assert found[-1] == (ROUND, round_)
    driving = [moment for timeline, moment in found if timeline == SIM_TIME]
    assert len(found) == len(said) + len(driving) + 1
    assert trip.departed < driving[0] <= trip.departed + 0.1 + 1e-9
    assert trip.ended - 0.1 - 1e-9 <= driving[-1] < trip.ended
    assert np.diff(driving) == pytest.approx(0.1)


def test_rounds_follow_each_other(rounds):
    together = frames_of(rounds, {"round": 3}, {"round": 5})
    apart = [frames_of(rounds, {"round": k}, {"round": k}) for k in (3, 4, 5)]
    assert together == [*apart[0][:-1], *apart[1][:-1], *apart[2]]


def test_while_robots_drive_others_talk(stream):
    """Where both go on at once, neither a transmission nor a moment of driving is left out."""
    found = frames_of(stream, {"round": 2}, {"round": 12})
    numbers = [moment for timeline, moment in found if timeline == MSG]
    driving = [moment for timeline, moment in found if timeline == SIM_TIME]
    assert numbers == sorted(numbers)
    assert len(numbers) > 20
    assert (np.diff(driving) > 0.0).all()
    trips = [trip for _, trip, _ in stream.witness.trips]
    for last, following in itertools.pairwise(driving):
        skipped = [min(following, t.ended) - max(last, t.departed) for t in trips]
        assert max(skipped) < 0.1 + 1e-9  # the time between two frames


def test_messages_and_times(rounds):
    assert frames_of(rounds, {"msg": 4}, {"msg": 6}) == [(MSG, 4), (MSG, 5), (MSG, 6)]
    times = [time for _, time in frames_of(rounds, {"sim_time": 1.0}, {"sim_time": 1.45})]
    assert times == pytest.approx([1.0, 1.1, 1.2, 1.3, 1.4, 1.45])


@pytest.mark.parametrize("ending", ["gif", "webp"])
def test_animations_show_every_frame(rounds, tmp_path, ending):
    told = []
    out = clip(
        rounds.path, {"msg": 3}, {"msg": 6}, tmp_path / f"c.{ending}", frames_per_second=4.0,
        dots_per_inch=50, progress=lambda done, of: told.append((done, of)),
    )  # fmt: skip
    with Image.open(out) as animation:
        assert animation.n_frames == 4
        shown = []
        for k in range(4):
            animation.seek(k)
            animation.load()
            shown.append(np.array(animation.convert("RGB")).astype(int))
            assert animation.info["duration"] == (1250 if k == 3 else 250)
    assert all((np.abs(b - a) > 60).any() for a, b in pairwise(shown))
    assert told == [(1, 4), (2, 4), (3, 4), (4, 4)]


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="ffmpeg is not installed")
def test_films(rounds, tmp_path):
    out = clip(rounds.path, {"msg": 3}, {"msg": 6}, tmp_path / "c.mp4", dots_per_inch=51)
    told = subprocess.run(
        [
            "ffprobe", "-v", "error", "-count_frames", "-show_entries",
            "stream=codec_name,nb_read_frames,width,height", "-of", "csv=p=0", out,
        ],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    codec, width, height, count = told.stdout.strip().split(",")
    assert codec == "h264"
    assert int(width) % 2 == int(height) % 2 == 0
    assert int(count) == 4 + 10  # the last one stays for a second


@pytest.mark.parametrize(
    ("start", "stop", "settings", "complaint"),
    [
        ({"msg": 5}, {"msg": 3}, {}, "from 5 to 3; expected the end last"),
        ({"msg": 5}, {"round": 3}, {}, "from a msg to a round; expected one timeline"),
        ({"msg": 1}, {"msg": 10**6}, {}, "there is no message 1e[+]06"),
        ({"round": 1}, {"round": 20}, {"speed": 1e-3}, "frames; expected 3000 or fewer"),
        ({"sim_time": 0}, {"sim_time": 30}, {"speed": 1e-9}, "frames; expected 3000 or fewer"),
        ({"msg": 1}, {"msg": 2}, {"speed": 0.0}, "speed is 0; expected more than 0"),
        ({"msg": 1}, {"msg": 2}, {"frames_per_second": -1.0}, "frames a second is -1; expected"),
        ({"msg": 1}, {"msg": 2}, {"theme": "pink"}, "theme 'pink'; expected one of light, dark"),
    ],
)
def test_clips_that_cannot_be(rounds, tmp_path, start, stop, settings, complaint):
    with pytest.raises(ValueError, match=complaint):
        clip(rounds.path, start, stop, tmp_path / "c.gif", **settings)


def test_kinds_of_clips_that_are_not_there(rounds, tmp_path, monkeypatch):
    with pytest.raises(ValueError, match=r"expected one of \.gif, \.mp4, \.webp"):
        clip(rounds.path, {"msg": 1}, {"msg": 2}, tmp_path / "c.png")
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(ValueError, match="takes ffmpeg, which is not installed"):
        clip(rounds.path, {"msg": 1}, {"msg": 2}, tmp_path / "c.mp4")
