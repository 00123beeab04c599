"""Runs are resumed on another number of MPI ranks."""

import shutil
import unittest

import h5py
import numpy

from tests.acceptance.on_ranks import BLOCK, PLATE, SHORT_BAR, SOLVER, Comparison, entries_of_checkpoint, rows


class GoesOn(Comparison):
    """On another number of ranks than before."""

    TEXT = PLATE.replace("steps = 2", "steps = 4") + SOLVER

    def stopped(self, ranks, text, *options):
        output = self.run_on(ranks, text, *options, words=("--stop-after", 2), code=130)
        self.assertEqual(len(rows(output, "history.csv")), 3)
        self.assertIn("peristat resume", self.ended.errors)
        return output

    def goes_on(self, ranks, output, whole, *options):
        folder = self.folder / f"{output.name}_resumed_on_{ranks}"
        shutil.copytree(output, folder)
        run = self.resume_on(ranks, folder, *options)
        self.assertIn("continuing after step 2", run.output)
        self.expect_same(whole, folder)
        self.expect_like_costs(whole, folder)
        with h5py.File(whole / "results.h5") as expected, h5py.File(folder / "results.h5") as found:
            self.assertEqual(entries_of_checkpoint(expected), entries_of_checkpoint(found))
        self.assertFalse((folder / "parts").exists())

    def whole(self, text):
        output = self.run_on(1, text)
        return output.rename(self.folder / "whole")

    def test_on_more_and_on_fewer_ranks(self):
        whole = self.whole(self.TEXT)
        of_two = self.stopped(2, self.TEXT)
        for ranks in (3, 1):
            with self.subTest(from_2_to=ranks):
                self.goes_on(ranks, of_two, whole)
        of_one = self.stopped(1, self.TEXT)
        self.goes_on(4, of_one, whole)

    def test_with_fields_that_are_not_written_yet(self):
        text = self.TEXT + "[output]\nevery = 3\nstress = true\n[[probe]]\nname = 'p'\nat = [0.5, 1.2]\n"
        text += "[[probe]]\nname = 'row'\nfrom = [0.1, 1.2]\nto = [0.9, 1.2]\nfield = 'stress'\n"
        self.goes_on(3, self.stopped(2, text), self.whole(text))

    def test_on_ranks_without_a_point(self):
        text = SHORT_BAR + SOLVER + "[loading]\nsteps = 3\n[output]\nevery = 3\n"
        whole = self.whole(text)
        self.goes_on(1, self.stopped(8, text), whole)
        self.goes_on(8, self.stopped(1, text), whole)

    def test_in_three_dimensions(self):
        block = BLOCK.replace("table = [0, 1, 0.5]", "steps = 4") + SOLVER
        self.goes_on(3, self.stopped(2, block), self.whole(block))

    def test_with_the_same_bits_on_as_many_ranks(self):
        whole = self.run_on(2, self.TEXT).rename(self.folder / "whole")
        output = self.stopped(2, self.TEXT)
        self.resume_on(2, output)
        with h5py.File(whole / "results.h5") as expected, h5py.File(output / "results.h5") as found:
            for name in ("steps/000004/displacement", "history/external_work", "history/reaction_y:top"):
                self.assertTrue(numpy.array_equal(expected[name], found[name]), name)

    def test_further_than_before(self):
        output = self.run_on(2, self.TEXT)
        again = self.resume_on(3, output)
        self.assertIn("has reached its end", again.output)
        self.assertEqual(again.output.count("has reached its end"), 1)
        self.resume_on(3, output, "loading.table=[0, 1, 0.5]")
        self.assertEqual(float(rows(output, "history.csv")[-1]["load_factor"]), 0.5)

    def test_of_another_body(self):
        output = self.stopped(2, self.TEXT)
        results = output / "results.h5"
        with h5py.File(results, "r+") as file:
            file["points/reference"][7, 1] += 1e-12
        said = self.resume_on(3, output, code=2).errors
        self.assertIn("its points differ from those", said)
        self.assertEqual(said.count("peristat:"), 1)

    def test_from_a_damaged_checkpoint(self):
        output = self.stopped(2, self.TEXT)
        with h5py.File(output / "results.h5", "r+") as file:
            file["checkpoint"][file["checkpoint"].size // 2] ^= 1  # flips a bit of a number
        self.assertIn("its checksum is wrong", self.resume_on(2, output, code=2).errors)


if __name__ == "__main__":
    unittest.main()
