"""Maps as ROS's map_server keeps them, and what is said when they are wrong."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

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


@pytest.mark.parametrize("mode", ["RGB", "LA", "P", "1"])
def test_images_of_other_kinds(folder, mode):
    """Alpha is a channel like the others, as map_server has it: an opaque grey is lighter."""
    Image.fromarray(np.where(PIXELS > 100, 255, 0).astype(np.uint8)).convert(mode).save(
        folder / "floor.png"
    )
    corner = read(folder).cells[1, 0]
    assert corner == (UNKNOWN if mode == "LA" else OCCUPIED)
    assert (read(folder).cells[0] == FREE).all()


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
        ("floor.png", "map.yaml", "map.yaml' is no image; expected a PNG file"),
        ("0.5 ", "-0.5 ", "resolution is '-0.5'; expected metres a pixel, more than 0"),
        ("0.5 ", "half ", "resolution is 'half'; expected metres a pixel"),
        ("0.5 ", "nan ", "resolution is 'nan'; expected metres"),
        ("0.65", "1.5", "occupied_thresh is '1.5'; expected 0 to 1"),
        ("0.196", "0.7", "free_thresh is 0.7; expected at most occupied_thresh"),
        ("negate: 0", "negate: 2", "negate is '2'; expected 0 or 1"),
        ("[-1.0, -2.0, 0.0]", "0", "origin is '0'; expected [x, y, yaw]"),
        ("[-1.0, -2.0, 0.0]", "[0, 0, up]", "origin is ['0', '0', 'up']; expected [x, y, yaw]"),
        ("negate: 0", "negate: 0\nmode: raw", "mode is 'raw'; expected 'trinary'"),
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
    (folder / "map.yaml").write_bytes(b"\xff\xfe\x00")
    assert "it is not UTF-8 text" in refusal(folder)
    (folder / "map.yaml").unlink()
    assert "cannot be read: No such file or directory" in refusal(folder)
    with pytest.raises(BadInput, match="is 3; expected the YAML file of a map"):
        occupancy_grid(3, "world.file")


def test_images_that_do_not_serve(folder):
    Image.fromarray(np.zeros((2, 2), np.uint16)).save(folder / "floor.png")
    assert "is of mode I;16; expected 8 bits a channel" in refusal(folder)
    whole = (folder / "floor.png").read_bytes()
    Image.fromarray(PIXELS).save(folder / "floor.png")
    (folder / "floor.png").write_bytes(whole[:40])
    assert "cannot be read" in refusal(folder) or "is no image" in refusal(folder)


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
