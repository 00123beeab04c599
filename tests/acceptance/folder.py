"""Common parts of tests through the program: a folder, runs in it, and checks of their endings."""

import os
import pathlib
import subprocess
import tempfile
import unittest

from tests.reference.clouds import toml
from tests.reference.program import PROGRAM, execute, settings
from tests.reference.results import Results


class Folder(unittest.TestCase):
    """Runs commands in a temporary folder, one per test."""

    threads = 1  # of runs

    def setUp(self):
        # The space detects unquoted paths.
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(prefix="peristat test "))).resolve()

    def write(self, name, text):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path

    def case(self, case):
        """The path of a case that is given as a path, as text or as tables."""
        if isinstance(case, pathlib.Path):
            return case
        return self.write("case.toml", case if isinstance(case, str) else toml(case))

    def execute(self, command, **options):
        return execute(command, **{"folder": self.folder, "seconds": 600} | options)

    def peristat(self, *arguments, **options):
        return self.execute([PROGRAM, *arguments], **options)

    def start(self, command, environment=None, **options):
        """A process that is killed at the end of the test."""
        options = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE} | options
        process = subprocess.Popen([str(word) for word in command], cwd=self.folder, text=True,
                                   env=os.environ | (environment or {}), **options)  # fmt: skip
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        return process

    def command(self, name, case, *changes, words=(), **options):
        """Runs a command on a case, with some keys changed by `key=value`."""
        return self.peristat(name, self.case(case), *words, *settings(*changes), **options)

    def run_case(self, case, *changes, name="out", words=(), threads=None, code=0, **options):
        """The folder of a run that ends with a code, or with one of several; `ended` is how it did."""
        self.ended = self.execute(self.words_of_run(case, *changes, name=name, words=words, threads=threads), **options)
        self.assert_code(self.ended, code)
        return self.folder / name

    def words_of_run(self, case, *changes, name="out", words=(), threads=None):
        words = ("--output", self.folder / name, "--overwrite", "--no-plots", "--threads", threads or self.threads, *words)
        return [PROGRAM, "run", self.case(case), *words, *settings(*changes)]

    def results(self, *arguments, **options):
        return Results(self.run_case(*arguments, **options))

    def resume(self, folder, *changes, words=(), threads=None, code=0, **options):
        """Continues a run; returns the ending."""
        words = ("--no-plots", "--threads", threads or self.threads, *words, *settings(*changes))
        ended = self.peristat("resume", self.folder / folder, *words, **options)
        self.assert_code(ended, code)
        return ended

    def refusal(self, case, *changes, **options):
        """The message of a refused run, which leaves no files."""
        self.assertFalse(self.run_case(case, *changes, name="refused", code=2, **options).exists())
        return self.ended.errors

    def assert_code(self, ended, code):
        """The exit code is the given one, or one of several."""
        self.assertIn(ended.code, code if isinstance(code, tuple) else (code,), ended.said)

    def assert_completed(self, ended):
        """Checks that a command succeeded; returns its ending."""
        self.assert_code(ended, 0)
        return ended

    def assert_refused(self, ended, *fragments):
        self.assert_code(ended, 2)
        for fragment in fragments:
            self.assertIn(fragment, ended.errors)
