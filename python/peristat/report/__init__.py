"""The report of a results folder: one page that needs no network (docs/report.md)."""
