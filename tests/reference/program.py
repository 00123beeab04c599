"""Runs peristat within limits of time and memory."""

import json
import os
import pathlib
import resource
import signal
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("PERISTAT_PROGRAM", str(ROOT / "build/release/peristat"))
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


def limit_address_space():
    resource.setrlimit(resource.RLIMIT_AS, (ADDRESS_SPACE, ADDRESS_SPACE))


def execute(command, folder=None, seconds=120, limited=True):
    """Runs a command in a process group of its own, which is killed when time is up."""
    command = [str(word) for word in command]
    process = subprocess.Popen(command, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, start_new_session=True,
                               preexec_fn=limit_address_space if limited else None)  # fmt: skip
    try:
        output, errors = process.communicate(timeout=seconds)
        code = process.returncode
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        output, errors = process.communicate()
        code = None
    return Ended(command, code, output.decode(errors="replace"), errors.decode(errors="replace"))


def peristat(*arguments, folder=None, seconds=120, limited=True):
    return execute([PROGRAM, *arguments], folder, seconds, limited)


def settings(**values):
    """Arguments for --set from keys with `__` for the dot."""
    return [word for key, value in values.items() for word in ("--set", f"{key.replace('__', '.')}={value}")]
