"""Maps as ROS's map_server keeps them, and what is said when they are wrong."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

import fleet
from fleet.cli import main
from fleet.scenario.errors import BadInput
from fleet.scenario.maps import occupancy_grid
from worlds.occupancy import FREE, OCCUPIED, UNKNOWN

EXAMPLE = Path(__file__).parents[3] / "examples" / "maps" / "office.yaml"

YAML = """\
image: floor.png
resolution: 0.5  # metres a pixel
origin: [-1.0, -2.0, 0.0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
"""
PIXELS = np.array([[0, 205, 254], [254, 254, 254]], np.uint8)


@pytest.fixture
def folder(tmp_path):
    Image.fromarray(PIXELS).save(tmp_path / "floor.png")
    (tmp_path / "map.yaml").write_text(YAML)
    return tmp_path


def read(folder):
    return occupancy_grid(str(folder / "map.yaml"), "world.file")


def refusal(folder):
    with pytest.raises(BadInput) as caught:
        read(folder)
    (problem,) = caught.value.problems
    assert problem[0] == "world.file"
    assert "\n" not in problem[1]
    return problem[1]


def test_the_image_becomes_cells_lower_row_first(folder):
    grid = read(folder)
    assert grid.resolution == 0.5
    assert grid.cells.tolist() == [[FREE, FREE, FREE], [OCCUPIED, UNKNOWN, FREE]]


def test_negate_swaps_black_and_white(folder):
    (folder / "map.yaml").write_text(YAML.replace("negate: 0", "negate: 1"))
    assert read(folder).cells.tolist() == [[OCCUPIED] * 3, [FREE, OCCUPIED, OCCUPIED]]


@pytest.mark.parametrize("text", ["negate: false", "negate: '0'", "negate: 0\nmode: trinary"])
def test_other_ways_to_write_the_same(folder, text):
    (folder / "map.yaml").write_text(
        YAML.replace("negate: 0", text)
        .replace("[-1.0, -2.0, 0.0]", "\n - -1\n - -2.0\n - 0")
        .replace("0.5 ", "5e-1 ")
        .replace("floor.png", '"floor.png"')
    )
    assert np.array_equal(read(folder).cells[1], [OCCUPIED, UNKNOWN, FREE])


@pytest.mark.parametrize("mode", ["RGB", "LA", "RGBA", "P", "1"])
def test_images_of_other_kinds_are_the_same_floor(folder, mode):
    Image.fromarray(np.where(PIXELS > 100, 255, 0).astype(np.uint8)).convert(mode).save(
        folder / "floor.png"
    )
    assert read(folder).cells.tolist() == [[FREE] * 3, [OCCUPIED, FREE, FREE]]


@pytest.mark.parametrize("mode", ["RGB", "LA", "RGBA"])
def test_grey_is_unknown_in_all_of_them(folder, mode):
    Image.fromarray(PIXELS).convert(mode).save(folder / "floor.png")
    assert read(folder).cells.tolist() == [[FREE] * 3, [OCCUPIED, UNKNOWN, FREE]]


def test_what_is_not_opaque_is_unknown(folder):
    alpha = np.array([[255, 255, 0], [255, 254, 255]], np.uint8)
    Image.merge("LA", [Image.fromarray(PIXELS), Image.fromarray(alpha)]).save(folder / "floor.png")
    assert read(folder).cells.tolist() == [[FREE, UNKNOWN, FREE], [OCCUPIED, UNKNOWN, UNKNOWN]]


def test_the_modes_of_map_server(folder):
    Image.fromarray(np.array([[0, 130, 254], [100, 20, 10]], np.uint8)).save(folder / "floor.png")
    for mode, floor in {
        "scale": [[UNKNOWN, OCCUPIED, OCCUPIED], [OCCUPIED, UNKNOWN, FREE]],
        "Raw": [[OCCUPIED, UNKNOWN, FREE], [FREE, UNKNOWN, UNKNOWN]],
    }.items():
        (folder / "map.yaml").write_text(YAML + f"mode: {mode}\n")
        assert read(folder).cells.tolist() == floor, mode


@pytest.mark.parametrize(
    "more", ["map_type: occupancy", "Mode: TRINARY", "mode: ~", "author: me", "cost_scale: 1"]
)
def test_keys_that_map_server_does_not_know_are_passed_over(folder, more):
    before = read(folder).cells.tolist()
    (folder / "map.yaml").write_text(YAML + more + "\n")
    assert read(folder).cells.tolist() == before


@pytest.mark.parametrize("yaw", ["nan", ".nan", "NaN", "0", "-0.0", "1e-12"])
def test_the_origin_is_the_corner_and_a_yaw_of_none_is_none(folder, yaw):
    (folder / "map.yaml").write_text(YAML.replace("[-1.0, -2.0, 0.0]", f"[-1.0, -2.0, {yaw}]"))
    assert read(folder).corner == (-1.0, -2.0)


def test_a_home_directory_is_found(folder, monkeypatch):
    monkeypatch.setenv("HOME", str(folder))
    (folder / "map.yaml").write_text(YAML.replace("floor.png", "~/floor.png"))
    assert occupancy_grid("~/map.yaml", "world.file").cells.shape == (2, 3)


def test_unknown_cells_that_count_as_free_are_said(folder):
    assert read(folder).notices == ()
    (folder / "map.yaml").write_text(YAML.replace("0.196", "0.25"))
    (said,) = read(folder).notices
    assert "free_thresh = 0.25 the grey 205" in said
    assert "16.7% of the cells" in said
    done = run(
        "--world", "map", "--set", f"world.file={folder / 'map.yaml'}", "--robots", "1",
        "--motion", "straight", "--rounds", "1",
    )  # fmt: skip
    assert done.exit_code == 0
    assert "free_thresh = 0.25 the grey 205" in done.stderr


MOVING_AI = """\
type octile
height 3
width 5
map
..@.W
.G@.T
..S..
"""
TRIPS = "version 1\n0\tx.map\t5\t3\t0\t0\t3\t0\t6.0\n0\tx.map\t5\t3\t1\t2\t4\t2\t3.0\n"


def test_a_moving_ai_map_and_its_trips(tmp_path):
    (tmp_path / "x.map").write_text(MOVING_AI)
    (tmp_path / "x.scen").write_text(TRIPS)
    grid = occupancy_grid(str(tmp_path / "x.map"), "world.file")
    assert grid.cells[::-1].tolist() == [
        [FREE, FREE, OCCUPIED, FREE, OCCUPIED],
        [FREE, FREE, OCCUPIED, FREE, OCCUPIED],
        [FREE] * 5,
    ]

    class Watch(fleet.Observer):
        def run_started(self, started):
            self.starts = [robot.position for robot in started.robots]
            self.goals = []

        def event_raised(self, event, source, time):
            self.goals.append(event.position)

    watch = Watch()
    world = {"name": "map", "file": str(tmp_path / "x.map"), "positions": str(tmp_path / "x.scen")}
    events = {"name": "trace", "occurrences": str(tmp_path / "x.scen"), "scale": 0.6}
    scenario = fleet.Scenario.of(
        world={**world, "cell": 0.6},
        events=events,
        motion="path",
        range=60.0,
        protocol={"name": "rfta2", "auctioneer_bids": True},
    )
    summary = fleet.run(scenario, [watch])
    assert np.allclose(watch.starts, [(0.3, 1.5), (0.9, 0.3)])
    assert np.allclose(watch.goals, [(2.1, 1.5), (2.7, 0.3)])
    assert summary.served == 2


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("width 5", "width x", "x.map: is no MovingAI map"),
        ("width 5", "width 6", "x.map:5: is '..@.W'; expected 6 of"),
        ("..S..\n", "", "x.map: has 2 rows; expected 3"),
        ("..S..", "..?..", "x.map:7: is '..?..'; expected 5 of"),
        ("height 3", "height 0", "x.map: is 5 × 0 cells"),
    ],
)
def test_a_wrong_moving_ai_map_is_said(tmp_path, old, new, said):
    (tmp_path / "x.map").write_text(MOVING_AI.replace(old, new))
    with pytest.raises(BadInput) as caught:
        occupancy_grid(str(tmp_path / "x.map"), "world.file")
    assert said in str(caught.value)


def test_a_file_that_changes_is_read_again(folder):
    before = read(folder)
    assert read(folder) is before
    Image.fromarray(255 - PIXELS).save(folder / "floor.png")
    assert read(folder).cells[1, 0] == FREE


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("image: floor.png\n", "", "map.yaml: image is missing; it is required"),
        ("floor.png", "", "image is missing"),
        ("floor.png", "[a, b]", "image is ['a', 'b']; expected the path of a file"),
        ("floor.png", "flor.png", "flor.png' cannot be read: No such file or directory"),
        ("floor.png", "map.yaml", "map.yaml' is no image; expected a PNG or PGM file"),
        ("0.5 ", "-0.5 ", "resolution is '-0.5'; expected metres a pixel, more than 0"),
        ("0.5 ", "half ", "resolution is 'half'; expected metres a pixel"),
        ("0.5 ", "nan ", "resolution is 'nan'; expected metres"),
        ("0.65", "1.5", "occupied_thresh is '1.5'; expected 0 to 1"),
        ("0.196", "0.7", "free_thresh is 0.7; expected at most occupied_thresh"),
        ("negate: 0", "negate: 2", "negate is '2'; expected 0 or 1"),
        ("[-1.0, -2.0, 0.0]", "0", "origin is '0'; expected [x, y, yaw]"),
        ("[-1.0, -2.0, 0.0]", "[0, 0, up]", "origin is ['0', '0', 'up']; expected [x, y, yaw]"),
        (
            "negate: 0",
            "negate: 0\nmode: row",
            "mode is 'row'; expected 'trinary', 'scale' or 'raw'",
        ),
        ("negate: 0", "negate: 0\nmod: raw", "unknown key 'mod'; did you mean 'mode'?"),
        ("[-1.0, -2.0, 0.0]", "[nan, 0, 0]", "expected [x, y, yaw]"),
        ("[-1.0, -2.0, 0.0]", "[0, 0, 1.57]", "a turned map cannot be used"),
        ("negate", "negat", "unknown key 'negat'; did you mean 'negate'?"),
        ("[-1.0, -2.0, 0.0]", "[-1.0, -2.0", "map.yaml:4: "),
        (YAML, "just text", "map.yaml: is no table of keys; expected image, resolution"),
        (YAML, "", "is no table of keys"),
    ],
)
def test_what_is_wrong_is_said_in_one_sentence(folder, old, new, said):
    assert old in YAML
    (folder / "map.yaml").write_text(YAML.replace(old, new))
    assert said in refusal(folder)


def test_files_that_are_not_there_or_not_text(folder):
    (folder / "map.yaml").write_bytes(b"\xff\x00\x81")
    assert "it is not UTF-8 text" in refusal(folder)
    (folder / "map.yaml").unlink()
    assert "no such file" in refusal(folder)
    with pytest.raises(BadInput, match="is 3; expected the YAML file of a map"):
        occupancy_grid(3, "world.file")


def test_images_that_do_not_serve(folder, monkeypatch):
    Image.fromarray(np.zeros((2, 2), np.uint16)).save(folder / "floor.png")
    assert "is of mode I;16; expected grey or colours of 8 bits" in refusal(folder)
    Image.new("CMYK", (3, 2)).save(folder / "floor.tif")
    (folder / "floor.tif").rename(folder / "floor.png")
    assert "is of mode CMYK" in refusal(folder)
    noise = np.random.default_rng(0).integers(0, 255, (50, 50))
    Image.fromarray(noise.astype(np.uint8)).save(folder / "floor.png")
    whole = (folder / "floor.png").read_bytes()
    for length in range(0, len(whole) - 40, 97):
        (folder / "floor.png").write_bytes(whole[:length])
        assert "cannot be read" in refusal(folder) or "is no image" in refusal(folder)


@pytest.mark.parametrize(
    "header",
    [
        b"P5",
        b"P5\n3",
        b"P5\n3 x\n255\n",
        b"P5 3 2 0\n",
        b"P5 3 2 255\nab",
        b"P5 -1 2 255\n",
        b"P5 99999999999999999999 1 255\n",
        b"P5 3 2 99999999\nabcdef",
        b"P2 3 2 255\n1 2 x",
    ],
)
def test_damaged_pgm_files_are_said(folder, header):
    (folder / "floor.png").write_bytes(header)
    assert len(refusal(folder)) < 500


def test_an_image_of_too_many_pixels_is_said(folder, monkeypatch):
    monkeypatch.setattr(Image, "MAX_IMAGE_PIXELS", 2)
    assert "has too many pixels" in refusal(folder)


def run(*arguments):
    return CliRunner().invoke(main, ["run", *arguments], catch_exceptions=False)


def test_the_example_map_runs_from_end_to_end():
    done = run(
        "--world", "map", "--set", f"world.file={EXAMPLE}", "--robots", "30", "--range", "4",
        "--rounds", "8", "--motion", "path", "--json",
    )  # fmt: skip
    assert done.exit_code == 0, done.output
    summary = json.loads(done.stdout)
    assert summary["served"] == 8
    assert summary["path_per_robot"] > summary["distance_per_robot"]


def test_a_wrong_map_is_exit_2(folder):
    (folder / "map.yaml").write_text(YAML.replace("negate: 0\n", ""))
    done = run("--world", "map", "--set", f"world.file={folder / 'map.yaml'}")
    assert done.exit_code == 2
    assert "world.file: " in done.stderr
    assert "negate is missing; it is required" in done.stderr
    assert "Traceback" not in done.output
