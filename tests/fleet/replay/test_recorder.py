"""The observer and the process behind it: when things go well, and when they do not."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import textwrap
import time
from math import dist
from pathlib import Path

import numpy as np
import pytest

from fleet.motion import Trip
from fleet.observer import Observer
from fleet.replay import recorder, scheme
from fleet.replay.failures import CannotRecord
from fleet.replay.journal import TripEnd
from fleet.replay.readback import Recording
from fleet.replay.rerun_recorder import RerunRecorder
from fleet.replay.viewer import viewer_binary, viewer_environment
from fleet.scenario.errors import BadInput
from fleet.scenario.loading import scenario_from

from .conftest import record, simulation


def rerun(*arguments):
    return subprocess.run(
        [viewer_binary(), "rrd", *map(str, arguments)],
        env=viewer_environment(), capture_output=True, text=True, check=False,
    )  # fmt: skip


def same(one, other):
    """Whether two recordings hold the same. Rerun itself takes no NaN for equal to another."""
    without = [path.with_suffix(".without.rrd") for path in (one, other)]
    for path, out in zip((one, other), without, strict=True):
        assert (
            rerun("filter", "--drop-entity", f"/{scheme.ROBOTS}", path, "-o", out).returncode == 0
        )
    rows = [Recording(path).rows(scheme.ROBOTS, "Points2D:positions") for path in (one, other)]
    return (
        rerun("compare", "--unordered", *without).returncode == 0
        and np.array_equal(*(np.array(row.values) for row in rows), equal_nan=True)
        and all(np.array_equal(*(row.moments[t] for row in rows)) for t in scheme.TIMELINES)
    )


def events(recording):
    return int(recording.span(scheme.ROUND)[1])


class Breaks(Observer):
    """Raises at the end of some trip."""

    def __init__(self, after):
        self.left = after

    def trip_ended(self, event, trip):
        self.left -= 1
        if not self.left:
            raise ArithmeticError("as planned")


def test_loading_the_package_loads_no_rerun_nor_matplotlib():
    code = "import fleet.replay, sys; print({'rerun', 'matplotlib', 'pyarrow'} & set(sys.modules))"
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert said.stdout.strip() == "set()"


def test_recording_loads_no_rerun_into_the_run():
    code = """
        import sys
        from pathlib import Path
        from fleet.assembly import run
        from fleet.replay import recorder
        from fleet.scenario.loading import scenario_from
        scenario = scenario_from({"motion": "straight", "robots": 20, "range": 4.0, "rounds": 2})
        run(scenario, [recorder(scenario, Path(sys.argv[1]))])
        print({'rerun', 'matplotlib', 'pyarrow'} & set(sys.modules))
    """
    said = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(code), os.devnull],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert said.stdout.strip() == "set()"


def test_the_file_is_sound(rounds):
    assert rerun("verify", rounds.path).returncode == 0


def test_the_same_seed_gives_the_same_recording(tmp_path):
    paths = [tmp_path / f"{k}.rrd" for k in range(3)]
    for path, seed in zip(paths, (4, 4, 5), strict=True):
        record(path, seed=seed, rounds=6)
    assert same(paths[0], paths[1])
    assert not same(paths[0], paths[2])


def test_how_often_notes_are_handed_on_changes_nothing(tmp_path):
    paths = [tmp_path / "often.rrd", tmp_path / "seldom.rrd"]
    for path, flush_rounds in zip(paths, (1, 1000), strict=True):
        record(path, rounds=8, flush_rounds=flush_rounds)
    assert same(*paths)


def test_a_run_that_breaks_off_leaves_all_it_did(tmp_path):
    path = tmp_path / "run.rrd"
    watching = RerunRecorder(path, key="k", properties={}, strict=True)
    with pytest.raises(ArithmeticError, match="as planned"):
        simulation([Breaks(7), watching], rounds=20).run()
    recording = Recording(path)
    assert events(recording) == 7
    assert rerun("verify", path).returncode == 0
    assert "summary" not in recording.properties
    assert scheme.ENERGY_MAP in recording.entities


def test_a_run_that_is_killed_leaves_what_it_had_handed_on(tmp_path):
    path = tmp_path / "run.rrd"
    code = f"""
        import os, signal
        from pathlib import Path
        from fleet.observer import Observer
        from fleet.replay.rerun_recorder import RerunRecorder
        from fleet.assembly import run
        from fleet.scenario.loading import scenario_from

        class Dies(Observer):
            left = 18
            def trip_ended(self, event, trip):
                self.left -= 1
                if not self.left:
                    os.kill(os.getpid(), signal.SIGKILL)

        scenario = scenario_from({{"motion": "straight", "robots": 40, "range": 3.0, "seed": 4}})
        watching = RerunRecorder(Path({str(path)!r}), key="k", properties={{}}, flush_rounds=5)
        print(watching.writer.process.pid, flush=True)
        run(scenario, [Dies(), watching])
    """
    killed = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(code)], stdout=subprocess.PIPE, text=True
    )
    with killed:
        writer = int(killed.stdout.readline())
        killed.wait()
    assert killed.returncode == -signal.SIGKILL
    deadline = time.monotonic() + 30.0
    while is_running(writer) and time.monotonic() < deadline:
        time.sleep(0.05)
    recording = Recording(path)
    assert events(recording) == 15
    assert rerun("verify", path).returncode == 0


def is_running(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return "Z" not in Path(f"/proc/{pid}/stat").read_text().split(")")[1][:3]


def test_the_end_of_a_trip_is_the_beginning_of_its_fields():
    assert Trip._fields[: len(TripEnd._fields)] == TripEnd._fields


def test_a_recording_that_fails_says_so(tmp_path):
    watching = RerunRecorder(tmp_path / "run.rrd", key="k", properties={}, flush_rounds=1)
    watching.writer.process.kill()
    with pytest.raises(RuntimeError, match=r"the recording .*run\.rrd broke off"):
        simulation([watching], rounds=10).run()


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no /dev/full here")
def test_a_full_disk_is_said_in_a_sentence(tmp_path):
    full = tmp_path / "full.rrd"
    full.symlink_to("/dev/full")
    done = subprocess.run(
        [sys.executable, "-m", "fleet", "run", "--motion", "straight", "--rrd", str(full)],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 1
    assert done.stderr == (
        f"fleet: the recording {full} broke off: No space left on device (os error 28)\n"
    )


def test_what_the_writer_died_of_is_told(tmp_path):
    watching = RerunRecorder(tmp_path / "run.rrd", key="k", properties={})
    watching.writer.tell("batch", "nonsense")
    with pytest.raises(RuntimeError, match="AssertionError") as caught:
        watching.closed()
    assert not isinstance(caught.value, CannotRecord)  # it is our fault: nobody may hide it
    assert "Traceback" in caught.value.__notes__[0]


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        ({"path": None}, "neither a file nor a viewer"),
        ({"path": Path("nowhere/at/all.rrd")}, "cannot record to nowhere/at/all.rrd"),
        ({"path": Path("/")}, "cannot record to /"),
        ({"flush_rounds": 0}, "flush_rounds is 0; expected 1 or more"),
        ({"sample_interval": 0.0}, "sample_interval is 0.0 s; expected more than 0"),
    ],
)
def test_bad_input(tmp_path, arguments, complaint):
    given = {"path": tmp_path / "run.rrd", "key": "k", "properties": {}, **arguments}
    with pytest.raises(ValueError, match=complaint):
        RerunRecorder(given.pop("path"), **given)


def test_a_user_is_told_where_nothing_can_be_recorded(tmp_path):
    scenario = scenario_from({"motion": "straight"})
    (tmp_path / "file").touch()
    for path in (Path("/proc/nothing/here.rrd"), tmp_path / "file" / "here.rrd", tmp_path):
        with pytest.raises(BadInput, match=f"cannot record to {path}: "):
            recorder(scenario, path)


@pytest.mark.parametrize("there", [True, False])
def test_a_run_that_is_refused_leaves_what_was_there(tmp_path, there):
    path = tmp_path / "run.rrd"
    if there:
        path.write_bytes(b"an older recording")
    options = ["--set", "robots=30", "--set", "range=0.1", "--motion", "straight", "--rrd", path]
    done = subprocess.run(
        [sys.executable, "-m", "fleet", "run", *map(str, options)],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 2
    assert "range is 0.1 m" in done.stderr
    assert path.exists() == there
    assert not there or path.read_bytes() == b"an older recording"


def test_the_folder_of_a_recording_is_made(tmp_path):
    watching = recorder(scenario_from({"motion": "straight"}), tmp_path / "a" / "b" / "run.rrd")
    simulation([watching], rounds=1).run()
    assert events(Recording(watching.path)) == 1


def test_the_key_is_that_of_the_scenario(tmp_path):
    keys = []
    for seed in (1, 1, 2):
        scenario = scenario_from({"motion": "straight", "robots": 10, "range": 6.0, "seed": seed})
        watching = recorder(scenario, tmp_path / "run.rrd")
        simulation([watching], robots=10, range=6.0, seed=seed, rounds=1).run()
        recording = Recording(watching.path)
        keys.append(recording.key)
        assert recording.properties["run"]["seed"] == seed
        assert recording.properties["run"]["robot_radius"] == scenario.robot.radius
        assert recording.properties["run"]["version"]
    assert keys[0] == keys[1] != keys[2]


@pytest.mark.slow
def test_bodies_driven_by_the_engine(tmp_path):
    """Physics bends the way: driven and straight paths differ, and so does the energy."""
    run = record(tmp_path / "run.rrd", motion="physics", robots=60, rounds=25, seed=3)
    for _, trip, _ in run.witness.trips:
        before = trip.ended - 1e-6  # then the next event clears the floor
        (way,) = run.recording.at(scheme.DRIVEN, "LineStrips2D:strips", scheme.SIM_TIME, before)
        assert way[0].tolist() == pytest.approx(trip.origin, abs=1e-5)
        assert dist(way[-1], trip.end) < 0.3
    foreseen, drained = run.recording.rows(scheme.TOTAL_ENERGY, "Scalars:scalars").values[-1]
    assert drained > 1.05 * foreseen


def test_the_planned_way_is_drawn_where_it_bends(tmp_path):
    run = record(
        tmp_path / "run.rrd",
        motion="path",
        world="warehouse",
        rounds=20,
        seed=3,
        robot={"capacity": 500.0},
    )
    bent = straight = 0
    for event, trip, _ in run.witness.trips:
        under_way = 0.5 * (trip.departed + trip.ended)
        strips = "LineStrips2D:strips"
        ways = run.recording.at(scheme.PLANNED, strips, scheme.SIM_TIME, under_way)
        ways = () if ways is None else ways
        length = sum(np.hypot(*np.diff(way, axis=0).T).sum() for way in ways)
        if trip.planned > 1.001 * dist(trip.origin, trip.site):
            (way,) = ways
            assert way[0].tolist() == pytest.approx(trip.origin, abs=1e-5)
            assert dist(way[-1], event.position) == pytest.approx(trip.offset, abs=1e-5)
            assert length == pytest.approx(trip.planned, rel=2e-3)
            bent += 1
        else:
            assert len(ways) == 0 or length == pytest.approx(trip.planned, rel=2e-3)
            straight += 1
    assert bent > 3
    assert straight > 3


def test_the_summary_is_printed_before_the_drawing_is_awaited(tmp_path, monkeypatch, capfd):
    """Whoever waits for the summary alone need not wait for the picture."""
    from fleet.cli import main
    from fleet.replay.writer_process import WriterProcess

    told = []
    finish = WriterProcess.finish

    def slow(self):
        told.append(capfd.readouterr().out)
        finish(self)

    monkeypatch.setattr(WriterProcess, "finish", slow)
    path = tmp_path / "run.rrd"
    arguments = ["run", "--motion", "straight", "--rounds", "2", "--rrd", str(path)]
    with pytest.raises(SystemExit) as ended:
        main(arguments)
    assert ended.value.code == 0
    assert "2 rounds" in told[0]
    assert capfd.readouterr().out.startswith(f"\nRecorded to {path}")
