"""Runs peristat within limits of time and memory."""

import json
import os
import pathlib
import resource
import signal
import subprocess
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.path.abspath(os.environ.get("PERISTAT_PROGRAM", ROOT / "build/release/peristat"))
PLOT = ["/usr/bin/python3", "-BEs", str(ROOT / "python/peristat/pictures/__main__.py")]
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


class Begun:
    """A command in a process group of its own, which is killed when time is up: see execute."""

    def __init__(self, command, folder=None, seconds=120, limited=True, cpu_seconds=None, environment=None):
        def set_limits():
            if limited:
                resource.setrlimit(resource.RLIMIT_AS, (ADDRESS_SPACE, ADDRESS_SPACE))
            if cpu_seconds:
                resource.setrlimit(resource.RLIMIT_CPU, (cpu_seconds, cpu_seconds + 5))

        self.command = [str(word) for word in command]
        self.latest_end = time.monotonic() + seconds
        self.process = subprocess.Popen(self.command, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                        stderr=subprocess.PIPE, start_new_session=True, preexec_fn=set_limits,
                                        env=os.environ | (environment or {}))  # fmt: skip

    def kill(self):
        """If it still runs."""
        if self.process.poll() is None:
            os.killpg(self.process.pid, signal.SIGKILL)
            self.process.communicate()

    def end(self):
        try:
            output, errors = self.process.communicate(timeout=max(0.0, self.latest_end - time.monotonic()))
            code = self.process.returncode
            if code == -signal.SIGXCPU:
                code = None
        except subprocess.TimeoutExpired:
            os.killpg(self.process.pid, signal.SIGKILL)
            output, errors = self.process.communicate()
            code = None
        return Ended(self.command, code, output.decode(errors="replace"), errors.decode(errors="replace"))


def execute(command, **limits):
    """How a command ends, within limits of `folder`, `seconds`, `limited`, `cpu_seconds` and `environment`.

    seconds is wall time, against hangs; cpu_seconds is processor time, which other load does not affect.
    The environment is added to that of this process.
    """
    return Begun(command, **limits).end()


def peristat(*arguments, **limits):
    return execute([PROGRAM, *arguments], **limits)
