"""Runs the program, one process at a time, and passes interrupts on to it."""

import os
import shutil
import signal
import subprocess
from dataclasses import dataclass


@dataclass
class Ending:
    """How a run ended: exit code as a shell tells it, and what was said on the error stream."""

    code: int
    message: str


class Program:
    """The program in a process group of its own, so that an interrupt reaches it once wherever it was
    sent (to the terminal's group or to this process alone). Should this process be killed, it is too.
    """

    def __init__(self, path: str):
        guard = ["setpriv", "--pdeathsig", "KILL"] if shutil.which("setpriv") else []
        self._command = [*guard, path]
        self._child: subprocess.Popen | None = None
        self._pending = 0  # interrupts to be passed on
        self.interrupted = False
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, self._interrupt)
        signal.signal(signal.SIGTSTP, self._pause)

    def run(self, arguments: list[str]) -> Ending:
        self._child = subprocess.Popen([*self._command, *arguments], text=True, errors="replace",
                                       stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                       stderr=subprocess.PIPE, process_group=0)  # fmt: skip
        self._pass_on()
        message = self._child.communicate()[1]
        code = self._child.returncode
        self._child = None
        code = 128 - code if code < 0 else code  # ended by a signal
        return Ending(130 if code == 128 + signal.SIGINT else code, message.strip())

    def _interrupt(self, number, frame) -> None:
        self.interrupted = True
        self._pending += 1
        self._pass_on()

    def _pass_on(self) -> None:
        while self._pending and self._child:
            self._pending -= 1
            self._child.send_signal(signal.SIGINT)

    def _pause(self, number, frame) -> None:
        """Stops with the program, and goes on with it."""
        child = self._child
        if child:
            child.send_signal(signal.SIGSTOP)
        os.kill(os.getpid(), signal.SIGSTOP)
        if child:
            child.send_signal(signal.SIGCONT)
