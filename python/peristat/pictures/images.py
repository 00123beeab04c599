"""Images of a body's points beyond planes of symmetry and periods, and the bonds that end at them."""

from typing import NamedTuple

import numpy as np


class ImageKinds(NamedTuple):
    """Maps points to their images: an image of kind k >= 1 of the point X is at mirror[k-1] X + shift[k-1]."""

    mirror: np.ndarray  # kinds x dimension
    shift: np.ndarray  # kinds x dimension [m]

    @staticmethod
    def none(dimension: int) -> "ImageKinds":
        return ImageKinds(np.zeros((0, dimension)), np.zeros((0, dimension)))

    def places(self, sources: np.ndarray, kind: np.ndarray) -> np.ndarray:
        """Positions of images, given the kind (0: the source itself) and the source (count x dimension) of each."""
        mirror = np.concatenate([np.ones_like(self.mirror, shape=(1, sources.shape[1])), self.mirror])
        shift = np.concatenate([np.zeros_like(self.shift, shape=(1, sources.shape[1])), self.shift])
        return mirror[kind] * sources + shift[kind]

    def all_places(self, sources: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Images of all kinds of all sources within a box, count x dimension."""
        found = [np.zeros((0, sources.shape[1]))]
        for mirror, shift in zip(self.mirror, self.shift):
            of_kind = mirror * sources + shift
            found.append(of_kind[((of_kind >= low) & (of_kind <= high)).all(axis=1)])
        return np.concatenate(found)


class BrokenBonds(NamedTuple):
    """Bonds that broke, in the order of breaking."""

    points: np.ndarray  # count x 2
    image: np.ndarray  # image kind of the second point at which the bond ends; 0: the point itself
    steps: np.ndarray  # in which they broke

    def until(self, step: int) -> "BrokenBonds":
        return BrokenBonds(*(values[self.steps <= step] for values in self))

    def inner(self) -> np.ndarray:
        """Points of the bonds that end at no image, count x 2."""
        return self.points[self.image == 0]

    def ends(self, reference: np.ndarray, kinds: ImageKinds) -> np.ndarray:
        """Positions of both ends, count x 2 x dimension."""
        first, second = self.points.T
        return np.stack([reference[first], kinds.places(reference[second], self.image)], axis=1)


def on_the_body(cracks: list, kinds: ImageKinds, low: np.ndarray, high: np.ndarray) -> list:
    """Cracks (vertices x dimension) and those of their images that may touch a box, each once."""
    found = list(cracks)
    for crack in cracks:
        for mirror, shift in zip(kinds.mirror, kinds.shift):
            image = mirror * crack + shift
            touches = (image.max(axis=0) >= low).all() and (image.min(axis=0) <= high).all()
            size = 1e-9 * (high - low).max()
            if touches and not any(_is_same(image, other, size) for other in found if len(other) == len(image)):
                found.append(image)
    return found


def _is_same(one: np.ndarray, other: np.ndarray, size: float) -> bool:
    """Whether two lists of vertices are equal, also in reverse order."""
    return any(np.abs(one - order).max() <= size for order in (other, other[::-1]))
