"""Pictures are drawn in several processes: results in order, faults raised, and no fork beside threads."""

import subprocess
import sys
import threading
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "python"))

from peristat.pictures import processes  # noqa: E402

PROGRAM = f"""
import os, sys, time
sys.path.insert(0, {str(ROOT / "python")!r})
os.sched_getaffinity = lambda process: {{0, 1}}
from peristat.pictures.processes import results_of
def task(number):
    def work():
        time.sleep(0.2 if number == 0 else 0)
        if number == WRONG:
            END
        return number, os.getpid()
    return work
found = list(results_of([task(number) for number in range(4)]))
print([number for number, _ in found], os.getpid() in [process for _, process in found])
"""


def run(wrong=None, end="pass"):
    text = PROGRAM.replace("WRONG", repr(wrong)).replace("END", end)
    return subprocess.run([sys.executable, "-BEs", "-c", text], capture_output=True, text=True, timeout=60)


class Processes(unittest.TestCase):
    def test_results_are_in_order_and_of_other_processes(self):
        self.assertEqual(run().stdout.strip(), "[0, 1, 2, 3] False")

    def test_what_a_task_raises_is_raised(self):
        self.assertIn("ValueError: of a task", run(2, 'raise ValueError("of a task")').stderr)

    def test_a_process_that_dies_is_an_error(self):
        self.assertIn("BrokenProcessPool", run(1, "os._exit(1)").stderr)

    def test_a_process_with_threads_is_not_forked(self):
        """OpenBLAS, for one, waits forever in a fork of a process whose threads it has used."""
        goes_on = threading.Event()
        thread = threading.Thread(target=goes_on.wait)
        thread.start()
        try:
            self.assertEqual(list(processes.results_of([threading.get_ident] * 2)), [threading.get_ident()] * 2)
        finally:
            goes_on.set()
            thread.join()


if __name__ == "__main__":
    unittest.main()
