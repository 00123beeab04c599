"""Runs the program in any number of processes, and passes interrupts on to them."""

import os
import shutil
import signal
import subprocess
import threading
from dataclasses import dataclass


@dataclass
class Ending:
    """How a run ended: exit code as a shell reports it, and the text of both streams."""

    code: int
    message: str
    output: str = ""


class Program:
    """Runs the program in process groups of its own, so that an interrupt reaches each process once, whether it was
    sent to the terminal's group or to this process alone. If this process is killed, so are the others. `run` may be
    called from several threads at once.
    """

    def __init__(self, path: str):
        guard = ["setpriv", "--pdeathsig", "KILL"] if shutil.which("setpriv") else []
        self._command = [*guard, path]
        self._lock = threading.Lock()
        self._children: dict[subprocess.Popen, int] = {}  # and the number of interrupts that each has received
        self._interrupts = 0
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, self._interrupt)
        signal.signal(signal.SIGTSTP, self._pause)

    @property
    def interrupted(self) -> bool:
        return self._interrupts > 0

    def run(self, arguments: list[str], told: bool = False, limit: float | None = None) -> Ending:
        """@param told whether standard output is kept
        @param limit seconds after which the run is interrupted
        """
        child = subprocess.Popen([*self._command, *arguments], text=True, errors="replace",
                                 stdin=subprocess.DEVNULL, stdout=subprocess.PIPE if told else subprocess.DEVNULL,
                                 stderr=subprocess.PIPE, process_group=0)  # fmt: skip
        with self._lock:
            self._children[child] = 0
        self._pass_on()
        try:
            output, message = child.communicate(timeout=limit)
        except subprocess.TimeoutExpired:
            child.send_signal(signal.SIGINT)
            output, message = child.communicate()
        with self._lock:
            del self._children[child]
        code = child.returncode
        code = 128 - code if code < 0 else code  # ended by a signal
        return Ending(130 if code == 128 + signal.SIGINT else code, message.strip(), output or "")

    def _interrupt(self, number, frame) -> None:
        self._interrupts += 1
        # In another thread: the interrupted code may hold the lock.
        threading.Thread(target=self._pass_on).start()

    def _pass_on(self) -> None:
        with self._lock:
            for child, received in self._children.items():
                for _ in range(self._interrupts - received):
                    child.send_signal(signal.SIGINT)
                self._children[child] = self._interrupts

    def _pause(self, number, frame) -> None:
        """Stops the program's processes with this one, and continues them with it."""
        children = list(self._children)
        for child in children:
            child.send_signal(signal.SIGSTOP)
        os.kill(os.getpid(), signal.SIGSTOP)
        for child in children:
            child.send_signal(signal.SIGCONT)
