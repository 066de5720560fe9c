"""``fleet energy``: is energy linear in distance, for a simulated robot or a real one's logs?"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from fleet.cli.exits import say
from fleet.cli.resuming import conclude, progress, resumable, this_command

if TYPE_CHECKING:
    from fleet.experiments.energy.settings import Subject
    from fleet.logs.asking import LogSettings
    from fleet.logs.judging import Judgement

_LOG = (
    click.option("--log", "logs", multiple=True, type=click.Path(path_type=Path),
                 metavar="FILE|FOLDER", help="Recorded drives of a real robot: CSV, ROS bags."),
    click.option("--log-column", "columns", multiple=True, metavar="ROLE=NAME*FACTOR",
                 help="Which column is what, such as v=speed*0.001. Repeatable."),
    click.option("--voltage", type=float, help="The battery's, in volts, if it is not logged."),
    click.option("--motor", metavar="K,R,BIAS",
                 help="Currents are the motors': V·s/m, Ω, A at standstill."),
    click.option("--track", type=float, help="Between the wheels, in metres."),
    click.option("--mass", type=float, help="In kilograms."),
    click.option("--offset", type=float, help="Of the battery's current, in amperes."),
    click.option("--electronics", type=float, help="Constant power not in the log, in watts."),
    click.option("--bodies", is_flag=True,
                 help="Drive simulated bodies on the recorded speeds, and say what they take."),
    click.option("--within", type=float, help="Error that a trip may have, in percent.  [10]"),
)  # fmt: skip


def _log_options(command: Callable[..., Any]) -> Callable[..., Any]:
    for option in reversed(_LOG):
        command = option(command)
    return command


@click.command("energy")
@click.argument("paths", nargs=-1, type=click.Path(path_type=Path),
                metavar="[SCENARIO|LOG...]")  # fmt: skip
@click.option("--out", type=click.Path(path_type=Path), required=True,
              help="Folder for results and report. What is there is not run again.")  # fmt: skip
@click.option("--quick", is_flag=True, help="A small part of it, on the open floor alone.")
@click.option("--seed", type=click.IntRange(min=0), default=0,
              help="The first seed of placements and networks.  [0]")  # fmt: skip
@click.option("--set", "settings", multiple=True, metavar="KEY=VALUE",
              help="Set any key of the scenario, such as robot.mass=20. Repeatable.")  # fmt: skip
@click.option("--workers", type=click.IntRange(min=1), help="Processes.  [all cores]")
@_log_options
def command(
    paths: tuple[Path, ...],
    out: Path,
    quick: bool,
    seed: int,
    settings: tuple[str, ...],
    workers: int | None,
    logs: tuple[Path, ...],
    **told: Any,
) -> None:
    """Test whether the energy of a trip is linear in its distance, as in Eq. (1).

    Thousands of tasks, traffic and whole lifetimes are driven; Eq. (1) is compared with what
    was drained, and robots that bid by it with robots that know better. Writes OUT/report.html,
    with figures (PNG, SVG) and their numbers (CSV) in OUT/figures. Interrupted and run again,
    it goes on where it was.

    With a SCENARIO file, or --set, the robots, floor and motion are those of the scenario, not the
    paper's.

    With --log, the trips are those of a real robot. A file is a run, a folder is a ground; what is
    told by options can also stand in a log.toml beside the files. Writes OUT/report.html,
    OUT/preset.toml (a robot for scenarios), OUT/trips.csv and OUT/windows.csv.
    """
    if logs:
        _only_without_log(settings)
        _judge_logs((*logs, *paths), out, told)
        return
    _only_with_log(paths, told)
    from fleet.experiments.energy.energy_study import energy_study
    from fleet.experiments.energy.settings import FULL, QUICK

    with resumable():
        results, page = energy_study(
            out, progress, size=QUICK if quick else FULL, seed=seed, workers=workers, say=say,
            command=this_command(), subject=_subject(paths, settings),
        )  # fmt: skip
        click.echo(f"Report: {page}")
        for result in results:
            if result.counts().failed:
                conclude(result)


def _subject(paths: tuple[Path, ...], settings: tuple[str, ...]) -> Subject | None:
    """Of the user's scenario; None: the paper's."""
    if not paths and not settings:
        return None
    from fleet.experiments.energy.own_subject import own_subject
    from fleet.scenario.loading import load_scenario

    return own_subject(load_scenario(paths[0] if paths else None, {}, settings))


def _only_without_log(settings: tuple[str, ...]) -> None:
    from fleet.scenario.errors import bad

    if settings:
        raise bad("--set", "says something of a scenario; a log has none")


def _only_with_log(paths: tuple[Path, ...], told: dict[str, Any]) -> None:
    from fleet.scenario.errors import bad

    if len(paths) > 1:
        raise bad(str(paths[1]), "is one file too many; logs of a real robot are given with --log")
    if paths and paths[0].suffix != ".toml":
        said = "is no scenario, which ends in .toml; logs of a real robot are given with --log"
        raise bad(str(paths[0]), said)
    for name, value in told.items():
        if value not in ((), None, False):
            option = "log-column" if name == "columns" else name
            raise bad(f"--{option}", "says something of logs; expected it together with --log")


def _judge_logs(paths: tuple[Path, ...], out: Path, told: dict[str, Any]) -> None:
    """Judge each ground, print what was chosen and found, and write the reports."""
    from fleet.logs.gathering import gather
    from fleet.logs.judging import judge
    from fleet.logs.log_report import write
    from fleet.logs.redriving import redrive, redriven_sentence

    driven = told.pop("bodies")
    judgements = [judge(ground) for ground in gather(paths, _settings(told))]
    for judgement in judgements:
        folder = out / judgement.ground.name if len(judgements) > 1 else out
        bodies = redrive(judgement) if driven else None
        page = write(judgement, folder, this_command(), bodies)
        _print_judgement(judgement)
        if bodies is not None:
            click.echo(f"  {redriven_sentence(bodies)}")
        click.echo(f"Report: {page}\n")
    if len(judgements) > 1:
        from fleet.logs.comparing import slopes_sentence

        click.echo(slopes_sentence(judgements))


def _settings(told: dict[str, Any]) -> LogSettings:
    from fleet.logs.asking import LogSettings, motor_constants
    from fleet.scenario.errors import BadInput, bad

    given = {name: value for name, value in told.items() if value is not None}
    if "motor" in given:
        given["motor"] = motor_constants(given["motor"])
    try:
        return LogSettings(**given)
    except BadInput:
        raise
    except ValueError as error:
        raise bad("--log", str(error)) from error


def _print_judgement(judgement: Judgement) -> None:
    from fleet.logs.log_report import closing_sentence
    from fleet.logs.sentences import (
        LEADS,
        outcome_sentences,
        summary_sentence,
        verdict_sentence,
    )  # fmt: skip

    ground = judgement.ground
    click.echo(f"{ground.name}: {summary_sentence(judgement)}")
    for note in ground.notes:
        click.echo(f"  {note}")
    click.echo()
    click.echo(LEADS[judgement.outcome])
    click.echo(verdict_sentence(judgement))
    for sentence in outcome_sentences(judgement):
        click.echo(f"  {sentence}")
    click.echo(f"  {closing_sentence(judgement)}")
