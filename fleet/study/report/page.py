"""The pages of all reports: one environment, one style, written whole or not at all."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined

from fleet.study.atomic import write_text
from fleet.study.report.style import SERIES, SERIES_DARK

HERE = "fleet.study.report"


def write_page(path: Path, template: str, package: str = HERE, **context: Any) -> Path:
    """Render a template of ``package``, which extends ``page.html.j2``, to a file; its path.

    Every name that the template uses is given, or rendering fails.
    """
    environment = Environment(
        loader=ChoiceLoader([PackageLoader(package, "."), PackageLoader(HERE, ".")]),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=StrictUndefined,
    )
    palette = list(zip(SERIES, SERIES_DARK, strict=True))
    write_text(path, environment.get_template(template).render(palette=palette, **context))
    return path
