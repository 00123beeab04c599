"""Runs of shipped cases that several tests use: each command runs once per build of the program.

They are stored beside the program, in shipped_runs/, and removed with the next build.
"""

import fcntl
import hashlib
import json
import pathlib
import shutil
import typing

from tests.reference.program import PROGRAM, ROOT, peristat, settings

RUNS = pathlib.Path(PROGRAM).parent / "shipped_runs"


class ShippedRun(typing.NamedTuple):
    folder: pathlib.Path
    code: int | None  # none: out of time
    output: str
    errors: str


def _build():
    """Identifies this build of the program."""
    return "".join(f"{path.name}{path.stat().st_mtime_ns}" for path in sorted(pathlib.Path(PROGRAM).parent.glob("*peristat*"))
                   if path.is_file())  # fmt: skip


def _remove_runs_of_other_builds(build):
    RUNS.mkdir(exist_ok=True)
    with open(RUNS / ".lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        known = RUNS / ".build"
        if known.exists() and known.read_text() == build:
            return
        for folder in RUNS.iterdir():
            if folder.is_dir():
                shutil.rmtree(folder)
        known.write_text(build)


def shipped_run(case, *changes, threads=1, seconds=900):
    """The end of a run of cases/CASE.toml with overrides `key=value`."""
    build = _build()
    _remove_runs_of_other_builds(build)
    path = ROOT / "cases" / f"{case}.toml"
    words = settings(*changes)
    key = hashlib.sha256("\0".join([path.read_text(), *words, str(threads)]).encode()).hexdigest()[:16]
    folder = RUNS / f"{path.stem}_{key}"
    with open(RUNS / f".{folder.name}.lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # others wait for the first
        if not (folder / "ended.json").exists():
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir()
            ended = peristat("run", path, "--output", folder / "out", "--threads", threads, *words,
                             seconds=seconds, limited=False)  # fmt: skip
            if ended.code is None:  # out of time, or killed: the next caller tries again
                return ShippedRun(folder / "out", None, ended.output, ended.errors)
            (folder / "ended.json").write_text(json.dumps([ended.code, ended.output, ended.errors]))
    return ShippedRun(folder / "out", *json.loads((folder / "ended.json").read_text()))
