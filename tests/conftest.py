"""Property tests find wrong values; how long one takes says something of the machine alone."""

from __future__ import annotations

from hypothesis import settings

settings.register_profile("without deadlines", deadline=None)
settings.load_profile("without deadlines")
