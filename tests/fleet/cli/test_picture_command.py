"""``fleet picture`` and ``fleet view`` as a user meets them."""

from __future__ import annotations

import pytest
from click.testing import CliRunner
from PIL import Image

from fleet.cli import main


def fleet(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    path = tmp_path_factory.mktemp("recorded") / "run.rrd"
    done = fleet(
        "run", "--motion", "straight", "--robots", 30, "--range", 3, "--rounds", 6, "--rrd", path
    )
    assert done.exit_code == 0
    return path


@pytest.mark.parametrize("at", ["round=3", "msg=5", "sim_time=2.5", "time=2.5", "message=5"])
def test_a_picture(recorded, tmp_path, at):
    out = tmp_path / "folder" / "p.png"
    done = fleet("picture", recorded, "--at", at, "-o", out)
    assert (done.exit_code, done.stdout) == (0, f"{out}\n")
    with Image.open(out) as image:
        assert image.width == 832
        assert len(image.convert("RGB").getcolors(1 << 20)) > 50


def test_style(recorded, tmp_path):
    out = tmp_path / "p.png"
    done = fleet(
        "picture", recorded, "--at", "round=3", "--theme", "dark", "--width", 4, "--dpi", 50,
        "-o", out,
    )  # fmt: skip
    assert done.exit_code == 0
    with Image.open(out) as image:
        assert image.width == 200
        assert max(image.convert("RGB").getpixel((0, 0))) < 64


def test_a_clip(recorded, tmp_path):
    out = tmp_path / "c.gif"
    done = fleet(
        "picture", recorded, "--from", "msg=2", "--to", "msg=4", "--fps", 5, "--dpi", 40, "-o", out
    )
    assert (done.exit_code, done.stdout) == (0, f"{out}\n")
    with Image.open(out) as animation:
        assert animation.n_frames == 3
        assert animation.info["duration"] == 200


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["--at", "round=900"], "there is no round 900; expected 0 to 6"),
        (["--at", "round=2.5"], "expected a whole number"),
        (["--at", "round"], "expected round=12, msg=345 or sim_time=6.78"),
        (["--at", "round=nan"], "expected round=12, msg=345 or sim_time=6.78"),
        (["--at", "frame=3"], "expected round=12, msg=345 or sim_time=6.78"),
        ([], "expected either --at, for a picture, or --from and --to, for a clip"),
        (["--from", "round=1"], "expected either --at"),
        (["--at", "round=1", "--to", "round=2"], "expected either --at"),
        (["--from", "round=3", "--to", "round=1"], "no such kind of clip"),
        (["--from", "round=3", "--to", "round=1", "-o", "c.gif"], "expected the end last"),
        (["--from", "round=3", "--to", "msg=1", "-o", "c.gif"], "expected one timeline"),
        (["--at", "round=1", "-o", "p.doc"], "no such kind of picture"),
        (["--at", "round=1", "-o", "/proc/p.png"], "cannot write /proc/p.png"),
        (["--at", "round=1", "--theme", "pink"], "'pink' is not one of"),
        (["--from", "msg=1", "--to", "msg=2", "--fps", "0", "-o", "c.gif"], "expected more than 0"),
    ],
)
def test_bad_input_is_one_sentence_and_exit_code_2(
    recorded, tmp_path, monkeypatch, arguments, complaint
):
    monkeypatch.chdir(tmp_path)
    done = fleet("picture", recorded, "-o", "p.png", *arguments)
    assert done.exit_code == 2
    assert done.stdout == ""
    assert complaint in done.stderr
    assert "Traceback" not in done.stderr
    said = [line for line in done.stderr.splitlines() if line]
    assert [line.startswith(("Usage:", "Try ")) for line in said].count(False) == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("command", [["view"], ["picture", "--at", "round=1", "-o", "p.png"]])
@pytest.mark.parametrize(
    ("content", "complaint"), [(None, "o such file"), (b"Dear reader,", "not a Rerun recording")]
)
def test_files_that_are_no_recordings(tmp_path, monkeypatch, command, content, complaint):
    monkeypatch.chdir(tmp_path)
    if content:
        (tmp_path / "x.rrd").write_bytes(content)
    done = fleet(*command, "x.rrd")
    assert done.exit_code == 2
    assert complaint in done.stderr
    assert len(done.stderr.splitlines()) == 1


def test_no_screen_to_open_a_window_on(recorded, monkeypatch):
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"):
        monkeypatch.delenv(name, raising=False)
    done = fleet("view", recorded)
    assert done.exit_code == 2
    assert "cannot open a window here: there is no screen; try --web" in done.stderr
