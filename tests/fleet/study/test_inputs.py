"""A row is the same only if everything that made it is."""

from __future__ import annotations

import json

import pytest

from fleet.scenario.local_code import code_of
from fleet.study import BrokenOff, Job, StudyResult
from fleet.study.study_file import study_from
from fleet.study.sweeping import sweep

MINE = """\
import protocols.metrics
from helper import weight
{also}

def nearest(robot, site):
    {late}
    return weight() * protocols.metrics.distance(robot, site)
"""
STUDY = {"scenario": {"motion": "straight", "rounds": 4, "robots": 40, "range": 3.0}, "seeds": 2}


def key(**scenario):
    return Job.of({"seed": 1, **scenario}).key


@pytest.mark.parametrize("name", ["starts.dat", "starts", "starts.csv", "mine.py"])
@pytest.mark.parametrize("place", ["world", "nested"])
def test_a_file_counts_by_content_whatever_its_suffix_and_wherever_it_is_named(
    tmp_path, name, place
):
    path = tmp_path / name
    path.write_text("1.0 2.0\n")
    scenario = {
        "world": {"world": {"name": "placed", "positions": str(path)}},
        "nested": {"any": [{"deep": str(path)}]},
    }[place]
    before = key(**scenario)
    assert key(**scenario) == before
    path.write_text("1.0 2.5\n")
    changed = key(**scenario)
    assert changed != before
    path.write_text("1.0 2.0\n")
    assert key(**scenario) == before


def test_a_name_of_no_file_is_a_name():
    assert "files" not in Job.of({"protocol": "rfta2", "x": ["a" * 5000, "\0", ":", ""]}).made_by


@pytest.fixture
def mine(tmp_path):
    """A metric with modules beside it: one it imports, one that one imports late, a package."""
    (tmp_path / "mine.py").write_text(MINE.format(also="from parts import inner", late=""))
    (tmp_path / "helper.py").write_text("def weight():\n    import late\n    return late.W\n")
    (tmp_path / "late.py").write_text("W = 1.0\n")
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "__init__.py").write_text("from . import deeper\n")
    (tmp_path / "parts" / "inner.py").write_text("X = 1\n")
    (tmp_path / "parts" / "deeper.py").write_text("X = 1\n")
    (tmp_path / "unread.py").write_text("X = 1\n")
    return tmp_path / "mine.py"


@pytest.mark.parametrize(
    ("module", "counts"),
    [
        ("helper.py", True), ("late.py", True), ("parts/__init__.py", True),
        ("parts/inner.py", True), ("parts/deeper.py", True), ("unread.py", False),
    ],
)  # fmt: skip
def test_modules_that_the_user_s_code_imports_count_and_no_others(mine, module, counts):
    scenario = {"protocol": {"name": "rfta2", "metric": f"{mine}:nearest"}}
    before = key(**scenario)
    path = mine.parent / module
    path.write_text(path.read_text() + "\nEDITED = True\n")
    assert (key(**scenario) != before) == counts


def test_code_is_read_not_run(tmp_path):
    ran = tmp_path / "ran"
    for name in ("mine", "helper"):
        (tmp_path / f"{name}.py").write_text(f"import helper\nopen({str(ran)!r}, 'w')\n")
    (tmp_path / "broken.py").write_text("def (:\n")
    assert [p.name for p in code_of(tmp_path / "mine.py").files] == ["mine.py", "helper.py"]
    assert [p.name for p in code_of(tmp_path / "broken.py").files] == ["broken.py"]
    assert not ran.exists()


def test_installed_packages_count_by_version_and_the_library_by_the_program_s(tmp_path):
    (tmp_path / "mine.py").write_text("import networkx, json, fleet\nimport protocols.metrics\n")
    code = code_of(tmp_path / "mine.py")
    assert (len(code.files), code.packages) == (1, ("networkx",))
    made_by = Job.of({"protocol": f"{tmp_path / 'mine.py'}:f"}).made_by
    assert made_by["packages"].keys() == {"networkx"}
    assert {"numpy", "numba", "scipy", "pymunk", "python"} <= made_by["libraries"].keys()


def test_another_library_is_another_row(monkeypatch):
    from fleet.study import inputs

    before, versions = key(), inputs.libraries()
    monkeypatch.setattr(inputs, "libraries", lambda: {**versions, "numpy": "9.9"})
    assert key() != before


def test_a_changed_helper_gives_new_rows_in_the_same_folder(mine, tmp_path):
    """The metric's sign decides who is sent: the helper turns it round."""
    study = STUDY | {"axes": {"protocol.metric": [f"{mine}:nearest"]}}
    near = sweep(study, tmp_path / "out", workers=1)
    first = [row["energy_drained"] for row in near.rows()]
    (mine.parent / "late.py").write_text("W = -1.0\n")
    again = [row["energy_drained"] for row in sweep(study, tmp_path / "out", workers=1).rows()]
    assert all(b > a for a, b in zip(first, again, strict=True))


def test_what_changes_while_a_study_runs_is_no_row_of_it(mine, tmp_path):
    study = study_from(STUDY | {"axes": {"protocol.metric": [f"{mine}:nearest"]}, "seeds": 3})

    def edit(counts):
        (mine.parent / "late.py").write_text("W = -1.0\n")

    with pytest.raises(BrokenOff, match=r"late.py' has changed since the study began"):
        sweep(study, tmp_path / "out", workers=1, progress=edit)
    assert sweep(study, tmp_path / "out", workers=1).counts() == (3, 3, 0)


def test_a_planted_work_function_is_not_called(tmp_path, make_tasks):
    """The ledger's job is that of its key, or none."""
    from fleet.scenario.errors import BadInput
    from fleet.study import run_jobs
    from fleet.study.open_ledger import writing

    out = tmp_path / "out"
    marker = tmp_path / "planted"
    with writing(out) as ledger:
        ledger.plan(make_tasks(2))
        ledger._database.execute("UPDATE job SET function = 'os:abort'")
    with pytest.raises(BadInput, match=r"is damaged: the job of run .* is not as it was written"):
        run_jobs(make_tasks(2), out, workers=1)
    with writing(out) as ledger:
        scenario = json.dumps({"n": 0, "log": str(marker)})
        ledger._database.execute("UPDATE job SET function = 'deeds:note', scenario = ?", [scenario])
    with pytest.raises(BadInput, match="is damaged"):
        run_jobs(make_tasks(2), out, workers=1)
    assert not marker.exists()
    assert StudyResult(out).counts().done == 0
