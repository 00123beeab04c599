"""docs/gallery.md has all shipped cases, with small pictures of runs of these cases as they are."""

import pathlib
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "docs/gallery"))

import make  # noqa: E402

AGAIN = "docs/gallery/make.py writes it anew"


class Gallery(unittest.TestCase):
    def test_every_case_has_been_run_as_it_is(self):
        entries = make.runs()
        self.assertEqual(set(entries), set(make.names()) - set(make.WITHOUT), AGAIN)
        for name in entries:
            self.assertEqual(entries[name]["keys"], make.keys_of(name), f"{name} has changed: {AGAIN}")
            self.assertGreater(entries[name]["points"], 0)
            self.assertTrue(make.picture_of(name).exists(), f"{name}: {AGAIN}")
        self.assertEqual(set(make.SHOWS), set(make.names()))

    def test_the_page_is_that_of_the_cases(self):
        self.assertEqual(make.PAGE.read_text("utf-8"), make.page(), AGAIN)

    def test_pictures_are_small_and_in_use(self):
        pictures = set(make.PICTURES.iterdir())
        self.assertEqual(pictures, {make.picture_of(name) for name in make.runs()})
        for picture in pictures:
            self.assertLessEqual(picture.stat().st_size, 40_000, picture.name)
            self.assertGreater(picture.stat().st_size, 1_000, picture.name)
        self.assertLess(sum(picture.stat().st_size for picture in pictures), 2_000_000)
        self.assertLess(make.FIRST[1].stat().st_size, 300_000)
        with make.Image.open(make.FIRST[1]) as animation:
            self.assertGreater(animation.n_frames, 15)


if __name__ == "__main__":
    unittest.main()
