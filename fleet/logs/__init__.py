"""Recorded logs of real robots: is their energy linear in distance, and if not, in what is it?

:func:`~fleet.logs.gathering.gather` makes runs of files, :func:`~fleet.logs.judging.judge`
judges the runs of a ground together, and :func:`~fleet.logs.log_report.write` leaves a report, a
preset and tables. Whoever has arrays instead of files makes the runs with
:func:`~fleet.logs.grounds.run_from_arrays`.
"""
