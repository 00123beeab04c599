"""A quarter of a ring of quadrilaterals whose sizes grow from its inner to its outer edge, and its exact strain energy.

Points stand at the centroids of the quadrilaterals and have their areas, as those of a mesh.
"""

import numpy


class GradedRing:
    """From radius 1 to `outer`, with `along` elements along the arc: sizes grow as the radii.

    shift  largest random shift of the inner corners, in sizes of the elements
    """

    def __init__(self, along, outer=4.25, shift=0.0, seed=1):
        angle = 0.5 * numpy.pi / along
        rows = round(numpy.log(outer) / angle)
        radii = outer ** (numpy.arange(rows + 1) / rows)
        turns = angle * numpy.arange(along + 1)
        corners = radii[:, None, None] * numpy.stack([numpy.cos(turns), numpy.sin(turns)], axis=-1)
        random = numpy.random.default_rng(seed).uniform(-shift, shift, corners.shape)
        corners[1:-1, 1:-1] += (random * (angle * radii)[:, None, None])[1:-1, 1:-1]
        quads = numpy.stack([corners[:-1, :-1], corners[1:, :-1], corners[1:, 1:], corners[:-1, 1:]])
        following = numpy.roll(quads, -1, axis=0)
        doubled = quads[..., 0] * following[..., 1] - quads[..., 1] * following[..., 0]
        area = 0.5 * doubled.sum(axis=0)
        centroid = ((quads + following) * doubled[..., None]).sum(axis=0) / (6 * area[..., None])
        self.places, self.areas = centroid.reshape(-1, 2), area.ravel()
        self.sizes = numpy.sqrt(self.areas)
        self.outer = outer

    def depth(self):
        """Distance of each point to the edges of the ring."""
        radius = numpy.hypot(*self.places.T)
        return numpy.min([radius - 1, self.outer - radius, *self.places.T], axis=0)

    def write(self, path, held):
        """The file of points; those of the mask `held` are in the set "held"."""
        rows = (f"{x!r}, {y!r}, {area!r}, {'held' if in_set else ''}\n"
                for (x, y), area, in_set in zip(self.places.tolist(), self.areas.tolist(), held))  # fmt: skip
        path.write_text("x, y, volume, set\n" + "".join(rows))


# Strains xx, yy and the shear angle xy.
STRAIN = numpy.array([1e-5, -2e-6, 5e-6])


def patch_test(points, horizon, quadrature="", material="", solver='[solver]\nlinear = "cholesky"'):
    """A ring in plane stress whose rim `held` has the displacements of STRAIN, as the text of a case."""
    xx, yy, xy = (float(component) for component in STRAIN)
    return f"""dimension = 2
[points]
file = "{points}"
horizon = {horizon}
thickness = 1
[quadrature]
{quadrature}
[material]
model = "bond"
youngs_modulus = 1e9
{material}
[[support]]
set = "held"
displacement = ["load*({xx!r}*x + {0.5 * xy!r}*y)", "load*({0.5 * xy!r}*x + {yy!r}*y)"]
{solver}
[output]
stress = true
"""


def exact(modulus=1e9, poisson=1 / 3):
    """Stress xx, yy, xy and energy density of STRAIN in plane stress."""
    xx, yy, xy = STRAIN
    plane = modulus / (1 - poisson**2)
    stress = numpy.array([plane * (xx + poisson * yy), plane * (yy + poisson * xx), plane * 0.5 * (1 - poisson) * xy])
    return stress, 0.5 * stress @ STRAIN


def errors(file, ring, inside):
    """Largest relative errors, inside the mask, of energy density, of stress (over its norm), and of displacement
    over that of the strain along the ring's radius; and the mean error of the energy density."""
    row = file["points/source_row"][()]
    last = file["steps"][max(file["steps"])]
    stress, density = exact()
    at = inside[row]
    xx, yy, xy = STRAIN
    moved = ring.places[row] @ numpy.array([[xx, 0.5 * xy], [0.5 * xy, yy]])
    of_energy = last["energy_density"][()][at] / density - 1
    of_stress = numpy.linalg.norm(last["stress"][()][at] - stress, axis=1) / numpy.linalg.norm(stress)
    of_displacement = numpy.linalg.norm(last["displacement"][()][at][:, :2] - moved[at], axis=1)
    scale = ring.outer * numpy.abs(STRAIN).max()
    return abs(of_energy).max(), of_stress.max(), of_displacement.max() / scale, of_energy.mean()
