"""What a study found, read from its folder: tables in memory, or as files.

The same lines open a table wherever it is wanted::

    pandas.read_parquet("runs.parquet")
    polars.read_parquet("runs.parquet")
    duckdb.sql("SELECT protocol, avg(lifetime) FROM 'runs.parquet' GROUP BY protocol")
"""

from __future__ import annotations

from collections.abc import Iterator
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fleet.scenario.errors import bad, unknown
from fleet.study.ledger import Counts, Failure, reading
from fleet.study.parquet import bring_up_to_date, runs_table, side_table

if TYPE_CHECKING:
    import pyarrow as pa

    from fleet.notebook_figure import NotebookFigure


class StudyResult:
    """The results in the folder ``out``, as far as the study has come.

    Every call reads the folder anew, also while a study is at work in it.
    """

    def __init__(self, out: str | Path) -> None:
        self.folder = Path(out)

    def __repr__(self) -> str:
        total, done, failed = self.counts()
        return f"<StudyResult {str(self.folder)!r}: {done} of {total} runs done, {failed} failed>"

    def _repr_html_(self) -> str:
        """How far it has come, and the means with their intervals, in a notebook."""
        from fleet.study.report.overview import table

        return f"<p>{escape(repr(self))}</p>{table(self.folder)}"

    def plot(self, *measures: str) -> NotebookFigure:
        """The means with their 95 % intervals, of these columns or of the first few that vary.

        Of the first combination of what is neither on the abscissa nor a colour; a notebook shows
        the figure, and its ``savefig`` writes it.

        Raises:
            BadInput: no run is done, or a measure is not there.
        """
        from fleet.study.report.overview import figure

        return figure(self.folder, measures)

    def report(self, out: str | Path | None = None) -> Path:
        """Write ``report.html`` into the folder, or into ``out``; its path.

        Raises:
            BadInput: the page cannot be written, or the study's ``[report]`` asks for what is
                not there.
        """
        from fleet.study.report.study_report import write_report

        return write_report(self.folder, None if out is None else Path(out))

    def counts(self) -> Counts:
        """How many runs there are to be, are done, and came to nothing."""
        with reading(self.folder) as ledger:
            return ledger.counts()

    def failures(self) -> list[Failure]:
        """The runs that came to nothing, with their keys and what was wrong."""
        with reading(self.folder) as ledger:
            return ledger.failures()

    def rows(self) -> Iterator[dict[str, Any]]:
        """The runs that are done, one after the other, as plain Python values."""
        with reading(self.folder) as ledger:
            yield from ledger.rows()

    def table_names(self) -> list[str]:
        """The tables that there are: ``runs``, and what the study asked for besides."""
        with reading(self.folder) as ledger:
            return ["runs", *ledger.table_names()]

    def table(self, name: str = "runs") -> pa.Table:
        """A table as pyarrow has it. In ``runs`` a row is a run that is done.

        Raises:
            BadInput: there is no table of that name.
        """
        with reading(self.folder) as ledger:
            if name == "runs":
                return runs_table(ledger.rows())
            names = ledger.table_names()
            if name not in names:
                raise bad("", unknown("table", name, ["runs", *names]))
            return side_table(ledger, name)

    def frame(self, name: str = "runs") -> Any:
        """A table as a pandas DataFrame.

        Raises:
            ModuleNotFoundError: pandas is not installed; it comes with the extra "pandas".
        """
        return self.table(name).to_pandas()

    def write(self) -> list[Path]:
        """See that each table is a Parquet file beside the ledger; none is ever half there.

        Files that were made from the ledger as it stands are left as they are.

        Raises:
            BrokenOff: the disk is full, or fails.
        """
        with reading(self.folder) as ledger:
            return bring_up_to_date(ledger, self.folder)
