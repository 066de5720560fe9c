"""Pictures and clips show what the recording holds, or say why they cannot."""

from __future__ import annotations

import numpy as np
import pytest
import rerun as rr
from PIL import Image

from fleet.replay import scheme
from fleet.replay.floor_figure import THEMES
from fleet.replay.readback import Recording
from fleet.replay.still import picture


def pixels(path):
    return np.array(Image.open(path).convert("RGB")).astype(int)


def painted(image, colour, tolerance=10):
    rgb = [colour >> shift & 255 for shift in (24, 16, 8)]
    return int((np.abs(image - rgb).max(axis=2) <= tolerance).sum())


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_hops_appear_when_they_are_made(rounds, tmp_path, theme):
    said = rounds.witness.said
    face = next(k for k, sent in enumerate(said) if sent.transmission.kind == "route-face")
    assert said[face - 1].transmission.kind == "route-greedy"
    shown = [
        pixels(picture(rounds.path, {"msg": said[k].number}, tmp_path / "p.png", theme=theme))
        for k in (face - 1, face + 1)  # the latest transmission is in the colour of the ink
    ]
    colours = THEMES[theme].kinds
    floors = [image[: image.shape[0] * 3 // 4] for image in shown]  # without the legend
    before, after = (painted(floor, colours["route-face"]) for floor in floors)
    assert before < 5
    assert after > 30
    assert painted(floors[1], colours["route-greedy"]) > 30
    legends = [image[image.shape[0] * 4 // 5 :] for image in shown]
    assert (legends[0] == legends[1]).all()  # it stays


def test_robots_are_drawn_in_the_colour_of_their_energy(rounds, tmp_path):
    image = pixels(picture(rounds.path, {"round": 0}, tmp_path / "p.png"))
    assert painted(image, 0xFDE725FF) > 40 * 50  # all batteries are full
    last = rounds.recording.span(scheme.ROUND)[1]
    image = pixels(picture(rounds.path, {"round": last}, tmp_path / "p.png"))
    assert painted(image, 0xFDE725FF) < 40 * 50


@pytest.mark.parametrize("ending", ["png", "pdf", "svg"])
def test_formats(rounds, tmp_path, ending):
    out = picture(rounds.path, {"sim_time": 3.0}, tmp_path / f"p.{ending}")
    assert out.stat().st_size > 5000


def test_a_stream_too(stream, tmp_path):
    image = pixels(picture(stream.path, {"sim_time": 20.0}, tmp_path / "p.png", theme="dark"))
    assert painted(image, scheme.EVENT_COLOUR) > 50


def test_nothing_is_cut_off(rounds, tmp_path):
    """All that is drawn lies within the picture: its outermost dots are the ground's."""
    image = pixels(picture(rounds.path, {"round": 4}, tmp_path / "p.png"))
    edges = np.concatenate([image[0], image[-1], image[:, 0], image[:, -1]])
    assert (edges == 255).all()


@pytest.mark.parametrize(
    ("at", "complaint"),
    [
        ({"round": 900}, r"there is no round 900; expected 0 to \d+"),
        ({"msg": -1}, r"there is no message -1; expected 0 to \d+"),
        ({"sim_time": 1e6}, r"there is no time 1e\+06 s; expected 0 to [\d.]+ s"),
        ({"frame": 3}, "timeline 'frame'; expected one of story, sim_time, round, msg"),
        ({}, "expected one of story, sim_time, round, msg"),
        ({"round": 1, "msg": 2}, "expected one of story, sim_time, round, msg"),
    ],
)
def test_moments_that_are_not_there(rounds, tmp_path, at, complaint):
    with pytest.raises(ValueError, match=complaint):
        picture(rounds.path, at, tmp_path / "p.png")


def test_themes_that_are_not_there(rounds, tmp_path):
    with pytest.raises(ValueError, match="theme 'pink'; expected one of light, dark"):
        picture(rounds.path, {"round": 1}, tmp_path / "p.png", theme="pink")


def test_kinds_of_pictures_that_are_not_there(rounds, tmp_path):
    with pytest.raises(
        ValueError, match=r"p\.doc: no such kind of picture; expected one of .*\.png"
    ):
        picture(rounds.path, {"round": 1}, tmp_path / "p.doc")


class TestFilesThatAreNoRecordings:
    def complaint(self, path):
        with pytest.raises(ValueError, match=path.name) as caught:
            Recording(path)
        message = str(caught.value)
        assert "\n" not in message
        return message

    def test_missing(self, tmp_path):
        assert "no such file" in self.complaint(tmp_path / "none.rrd")

    def test_empty(self, tmp_path):
        (tmp_path / "empty.rrd").touch()
        assert "not a Rerun recording" in self.complaint(tmp_path / "empty.rrd")

    def test_text(self, tmp_path):
        (tmp_path / "text.rrd").write_text("Dear reader, this is a letter.\n" * 20)
        assert "not a Rerun recording" in self.complaint(tmp_path / "text.rrd")

    @pytest.mark.parametrize("share", [0.1, 0.5, 0.9])
    def test_cut_off(self, rounds, tmp_path, share):
        path = tmp_path / "cut.rrd"
        whole = rounds.path.read_bytes()
        path.write_bytes(whole[: int(share * len(whole))])
        assert "cut off or damaged" in self.complaint(path)

    def test_of_something_else(self, tmp_path):
        path = tmp_path / "other.rrd"
        with rr.RecordingStream("something") as other:
            other.save(path)
            other.log("a", rr.Points2D([[1, 2]]), static=True)
            other.flush()
            other.disconnect()
        assert "not a recording of a fleet" in self.complaint(path)
