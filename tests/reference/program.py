"""Runs peristat within limits of time and memory."""

import json
import os
import pathlib
import resource
import signal
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.path.abspath(os.environ.get("PERISTAT_PROGRAM", ROOT / "build/release/peristat"))
PLOT = ["/usr/bin/python3", "-BEs", str(ROOT / "cases/runner/plots/plot.py")]
ADDRESS_SPACE = 6 << 30  # byte; OpenBLAS and Trilinos reserve far more than they use


class Ended:
    """How a program ended; `code` is None if it ran out of time and was killed."""

    def __init__(self, command, code, output, errors):
        self.command, self.code, self.output, self.errors = command, code, output, errors

    @property
    def said(self):
        return self.output + self.errors

    def json(self):
        return json.loads(self.output)


def settings(*changes):
    """Command-line arguments that change keys of a case, `key=value`."""
    return [word for change in changes for word in ("--set", change)]


def limited_by_shell(limits, command):
    """The command under limits of the shell, or with shell redirections: `ulimit -f 8`, `exec >/dev/full`."""
    return ["bash", "-c", f'{limits}; exec "$@"', "bash", *command]


def execute(command, folder=None, seconds=120, limited=True, cpu_seconds=None, environment=None):
    """Runs a command in a process group of its own, which is killed when its time is up.

    seconds is wall time, against hangs; cpu_seconds is processor time, which other load does not affect.
    The environment is added to that of this process.
    """
    def set_limits():
        if limited:
            resource.setrlimit(resource.RLIMIT_AS, (ADDRESS_SPACE, ADDRESS_SPACE))
        if cpu_seconds:
            resource.setrlimit(resource.RLIMIT_CPU, (cpu_seconds, cpu_seconds + 5))

    command = [str(word) for word in command]
    process = subprocess.Popen(command, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, start_new_session=True, preexec_fn=set_limits,
                               env=os.environ | (environment or {}))  # fmt: skip
    try:
        output, errors = process.communicate(timeout=seconds)
        code = process.returncode
        if code == -signal.SIGXCPU:
            code = None
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        output, errors = process.communicate()
        code = None
    return Ended(command, code, output.decode(errors="replace"), errors.decode(errors="replace"))


def peristat(*arguments, **limits):
    return execute([PROGRAM, *arguments], **limits)
