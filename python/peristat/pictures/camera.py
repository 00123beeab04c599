"""A camera for pictures of solids: projection, lights and page. It needs no graphics card and no display."""

import numpy as np

from .framing import placed
from .style import INK, points, size_of

AXES = "xyz"
TRIPOD = 1.1  # size of the directions' drawing [inch of the code]


class Camera:
    """Parallel projection that lays the body's longest direction across the picture.

    azimuth  angle of the view around the body [degrees]; None: chosen from the body's shape
    """

    def __init__(self, reference: np.ndarray, displacement: np.ndarray, azimuth: float | None = None):
        extent = np.ptp(reference, axis=0)
        across = int(np.argmax(extent))
        others = [axis for axis in range(3) if axis != across]
        motion = np.abs(displacement).max(axis=0)
        # The axis along which the body moves most points up, so that bending is seen; z if there is no difference.
        up = others[0] if motion[others[0]] > 1.01 * motion[others[1]] else others[1]
        a, b = np.eye(3)[across], np.eye(3)[up]
        c = np.cross(a, b)  # out of the picture
        slender = extent[across] > 3.0 * np.sort(extent)[1]
        own, elevation = np.radians((24.0, 20.0) if slender else (33.0, 25.0))
        azimuth = own if azimuth is None else np.radians(azimuth)
        self.across = 3 - across - int(np.argmax(b))  # the axis that points most towards the viewer
        self.right = np.cos(azimuth) * a - np.sin(azimuth) * c
        self.towards = np.cos(elevation) * (np.sin(azimuth) * a + np.cos(azimuth) * c) + np.sin(elevation) * b
        self.up = np.cross(self.towards, self.right)
        self.light = _unit(self.towards + 0.6 * self.up - 0.5 * self.right)
        self.fill_light = _unit(self.towards + 1.2 * self.right)

    def project(self, places: np.ndarray) -> np.ndarray:
        """Picture coordinates (right, up) of positions, whose last axis is x, y, z."""
        return places @ np.stack([self.right, self.up], axis=1)

    def depth(self, places: np.ndarray) -> np.ndarray:
        """Depth coordinate of positions; it grows towards the viewer."""
        return places @ self.towards

    def far_to_near(self, faces: np.ndarray) -> np.ndarray:
        """The order in which to draw faces (count x 4 x 3)."""
        return np.argsort(self.depth(faces.mean(axis=1)), kind="stable")


def _unit(vector):
    return vector / np.linalg.norm(vector)


def normals(faces: np.ndarray) -> np.ndarray:
    """Normals of quadrilaterals, not normalised."""
    return np.cross(faces[:, 2] - faces[:, 0], faces[:, 3] - faces[:, 1])


def lit(colours: np.ndarray, faces: np.ndarray, camera) -> np.ndarray:
    """Colours under a main light from the upper left and a weak light from the right."""
    normal = normals(faces)
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
    main = np.clip(normal @ camera.light, 0.0, 1.0)
    fill = np.clip(normal @ camera.fill_light, 0.0, 1.0)
    brightness = np.clip(0.50 + 0.46 * main + 0.16 * fill, 0.0, 1.05)[:, None]
    sheen = 0.10 * (main**12)[:, None]
    lit = colours.copy()
    lit[:, :3] = np.clip(lit[:, :3] * brightness + sheen, 0.0, 1.0)
    return lit


def darker(colours: np.ndarray, factor: float) -> np.ndarray:
    darker = colours.copy()
    darker[:, :3] *= factor
    return darker


def stage(low, high, words, bar: str | None, room: float = 1.1, foot: float = 0.0):
    """A figure in the proportions of the projected body: figure, axes, place of the colour bar, inches per metre.

    words  of the heading; bar  label of the colour bar; room  width of its ticks' labels; foot  height of a legend
    """
    figure, box, place, _ = placed(low, high, words, bar, 0.5, TRIPOD, room, foot)
    total_width, total_height = figure.get_size_inches()
    scale = min(box[2] * total_width / (high - low)[0], box[3] * total_height / (high - low)[1])
    axes = figure.add_axes([0.0, 0.0, 1.0, 1.0], zorder=0)
    axes.axis("off")
    # The axes cover the figure, one unit per metre, so that the body may leave its box when it deforms.
    middle = 0.5 * (low + high)
    x, y = (box[0] + 0.5 * box[2]) * total_width, (box[1] + 0.5 * box[3]) * total_height
    axes.set_xlim(middle[0] - x / scale, middle[0] + (total_width - x) / scale)
    axes.set_ylim(middle[1] - y / scale, middle[1] + (total_height - y) / scale)
    return figure, axes, place, scale


def draw_directions(figure, camera, under: float = 0.0) -> None:
    """A small tripod of the coordinate axes in the lower left corner, a height above the edge."""
    width, height = size_of(figure)
    tripod = figure.add_axes([0.1 / width, (0.05 + under) / height, TRIPOD / width, TRIPOD / height], zorder=3)
    tripod.axis("off")
    arrows = camera.project(np.eye(3))
    middle = 0.5 * (np.minimum(arrows.min(axis=0), 0) + np.maximum(arrows.max(axis=0), 0))
    for name, arrow in zip(AXES, arrows):
        tripod.annotate("", arrow, (0, 0), arrowprops={"arrowstyle": "-|>", "color": INK, "lw": points(1.3),
                                                       "mutation_scale": points(10)})  # fmt: skip
        tripod.text(*(1.28 * arrow), name, ha="center", va="center", fontsize="small", color=INK)
    tripod.set_xlim(middle[0] - 1.0, middle[0] + 1.0)
    tripod.set_ylim(middle[1] - 1.0, middle[1] + 1.0)
