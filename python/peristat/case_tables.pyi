# Written by tests/unit/cases/python_stub_test.py --write from docs/case.schema.json.
"""Types of the tables of a case: the keys of case files, for editors and type checkers."""

from collections.abc import Callable, Iterable, Mapping, MutableMapping, MutableSequence
from typing import Any, Generic, Literal, TypeAlias, TypeVar

from numpy.typing import ArrayLike

Quantity: TypeAlias = float | str
"""A number in SI units or those of the case, or a text with its unit: "210 GPa"."""
Expression: TypeAlias = float | str | Callable[..., Any]
"""A number, a text such as "0.1 mm * load", or a function of Python whose parameters say on what it depends."""
List: TypeAlias = ArrayLike | list[Any] | tuple[Any, ...]
"""Values in a list, tuple or array, or lists of them."""

_Kind = TypeVar("_Kind")

class Inner(Generic[_Kind]):
    """A table in a table, to which a dict can be assigned."""

    def __get__(self, table: Any, owner: Any) -> _Kind: ...
    def __set__(self, table: Any, value: Mapping[str, Any]) -> None: ...

class Array(Generic[_Kind]):
    """An array of tables, to which a list of dicts can be assigned."""

    def __get__(self, table: Any, owner: Any) -> MutableSequence[_Kind]: ...
    def __set__(self, table: Any, value: Iterable[Mapping[str, Any]]) -> None: ...

class Table(MutableMapping[str, Any]):
    def __getitem__(self, key: str) -> Any: ...
    def __setitem__(self, key: str, value: Any) -> None: ...
    def __delitem__(self, key: str) -> None: ...
    def __iter__(self) -> Any: ...
    def __len__(self) -> int: ...
    def plain(self) -> dict[str, Any]: ...

class Units(Table):
    length: str
    """unit of lengths: `'mm'`. Default: m. Allowed: a unit of this quantity"""
    time: str
    """unit of times: `'ms'`. Default: s. Allowed: a unit of this quantity"""
    force: str
    """unit of forces: `'kN'`. Default: from `stress`, `energy` or `mass`, otherwise N. Allowed: a unit of this quantity"""
    stress: str
    """unit of stresses: `'MPa'`. Default: force / length². Allowed: a unit of this quantity"""
    energy: str
    """unit of energies: `'mJ'`. Default: force · length. Allowed: a unit of this quantity"""
    mass: str
    """unit of masses: `'t'`. Default: force · time² / length. Allowed: a unit of this quantity"""

class LatticeShape(Table):
    add: Literal["box", "disk", "ellipse", "cylinder", "sphere", "polygon", "image", "stl"]
    """kind of the shape to add. exactly one of `add`, `subtract`. Allowed: `'box'` (1D, 2D, 3D), `'disk'`, `'ellipse'` (2D), `'polygon'` (2D; in 3D, where it is infinite in z, only to subtract), `'image'` (2D), `'cylinder'`, `'sphere'`, `'stl'` (3D)"""
    subtract: Literal["box", "disk", "ellipse", "cylinder", "sphere", "polygon", "image", "stl"]
    """kind of the shape to subtract. exactly one of `add`, `subtract`. Allowed: `'box'` (1D, 2D, 3D), `'disk'`, `'ellipse'` (2D), `'polygon'` (2D; in 3D, where it is infinite in z, only to subtract), `'image'` (2D), `'cylinder'`, `'sphere'`, `'stl'` (3D)"""
    name: str
    """name of the shape, by which loads refer to its boundary. Default: `''`"""
    cuts_bonds: bool
    """`subtract`: whether bonds that cross the shape are cut. Otherwise bonds longer than its width bridge it. Default: false. Allowed: true, false"""
    min: List
    """box, image: lower corner [m]. required. Allowed: a number per dimension; below `max`"""
    max: List
    """box, image: upper corner [m]. required. Allowed: a number per dimension"""
    centre: List
    """disk, ellipse, cylinder, sphere: centre [m]. required. Allowed: a number per dimension"""
    radius: Quantity
    """disk, cylinder, sphere: radius [m]. required. Allowed: positive"""
    radii: List
    """ellipse: radii along its two axes [m]. required. Allowed: a number per dimension; positive"""
    angle: Quantity
    """ellipse: angle from x to the axis of the first radius, anticlockwise [degrees]. Default: 0. Allowed: -360 to 360"""
    axis: List
    """cylinder: direction of its axis. Default: `[0, 0, 1]`. Allowed: a number per dimension; not zero"""
    length: Quantity
    """cylinder: length along its axis, half to each side of the centre [m]. Default: infinite. Allowed: positive; finite if it is added"""
    vertices: List
    """polygon: corners in order. The last corner is joined to the first [m]. exactly one of `vertices`, `file`. Allowed: 3 or more pairs `[x, y]`; around an area"""
    file: str
    """polygon (instead of `vertices`): file with corners x, y; image: PNG or TIFF picture; stl: STL surface. The path is relative to the case file's folder. exactly one of `vertices`, `file`. Allowed: an existing file"""
    scale: Quantity
    """polygon, stl: length of 1 in the file [m]. Default: 1, or the `length` of `[units]`. Allowed: positive"""
    grey: List
    """image: smallest and largest grey value of the pixels inside the shape, 0 (black) to 255, or to 65535 in files with 16 bits. required. Allowed: two numbers, the second not below the first"""
    translate: List
    """stl: shift after the scaling [m]. Default: `[0.0, 0.0]`. Allowed: a number per dimension"""

class LatticeRefine(Table):
    shape: Literal["box", "disk", "ellipse", "cylinder", "sphere", "polygon", "image", "stl"]
    """kind of the region, which has smooth sides and may reach beyond the body. required. Allowed: `'box'` (1D, 2D, 3D), `'disk'`, `'ellipse'` (2D), `'polygon'` (2D; in 3D, where it is infinite in z, only to subtract), `'image'` (2D), `'cylinder'`, `'sphere'`, `'stl'` (3D)"""
    spacing: Quantity
    """distance of points in the region [m]. required. Allowed: positive; below `lattice.spacing`, at least 1/64 of it"""
    growth: float
    """by how much the spacing grows per distance from the region, up to `lattice.spacing`. Default: 0.1. Allowed: 0.01 to 0.5"""
    min: List
    """box, image: lower corner [m]. required. Allowed: a number per dimension; below `max`"""
    max: List
    """box, image: upper corner [m]. required. Allowed: a number per dimension"""
    centre: List
    """disk, ellipse, cylinder, sphere: centre [m]. required. Allowed: a number per dimension"""
    radius: Quantity
    """disk, cylinder, sphere: radius [m]. required. Allowed: positive"""
    radii: List
    """ellipse: radii along its two axes [m]. required. Allowed: a number per dimension; positive"""
    angle: Quantity
    """ellipse: angle from x to the axis of the first radius, anticlockwise [degrees]. Default: 0. Allowed: -360 to 360"""
    axis: List
    """cylinder: direction of its axis. Default: `[0, 0, 1]`. Allowed: a number per dimension; not zero"""
    length: Quantity
    """cylinder: length along its axis, half to each side of the centre [m]. Default: infinite. Allowed: positive; finite if it is added"""
    vertices: List
    """polygon: corners in order. The last corner is joined to the first [m]. exactly one of `vertices`, `file`. Allowed: 3 or more pairs `[x, y]`; around an area"""
    file: str
    """polygon (instead of `vertices`): file with corners x, y; image: PNG or TIFF picture; stl: STL surface. The path is relative to the case file's folder. exactly one of `vertices`, `file`. Allowed: an existing file"""
    scale: Quantity
    """polygon, stl: length of 1 in the file [m]. Default: 1, or the `length` of `[units]`. Allowed: positive"""
    grey: List
    """image: smallest and largest grey value of the pixels inside the shape, 0 (black) to 255, or to 65535 in files with 16 bits. required. Allowed: two numbers, the second not below the first"""
    translate: List
    """stl: shift after the scaling [m]. Default: `[0.0, 0.0]`. Allowed: a number per dimension"""

class LatticeLayer(Table):
    name: str
    """name of the layer and of its set. required. Allowed: letters, digits, `_`, `-`; at most 100 characters; no other set or layer has it"""
    side: Literal["x-", "x+", "y-", "y+", "z-", "z+"]
    """side of the body. required. Allowed: `'x-'`, `'x+'`, and so on for y and z"""
    thickness: int
    """number of planes [spacings]. Default: 3. Allowed: 1 to 1000"""
    where: str
    """expression; the layer keeps only the points where it is not zero. Default: all points of the layer. Allowed: an expression of place"""

class Lattice(Table):
    spacing: Quantity | List
    """distance between neighbouring points, or one distance along each of the lattice's axes [m]. required. Allowed: positive, or a list with one number per dimension"""
    points: Literal["lattice", "blue_noise"]
    """`'lattice'`: points on the lattice; `'blue_noise'`: points at random, at about the spacing from their neighbours, with the volumes of their Voronoi cells. Default: `'lattice'`. Allowed: `'lattice'`, `'blue_noise'`; `blue_noise` with models `bond`, `state` and `lps` as an energy"""
    lloyd_steps: int
    """number of times that points of blue noise move to the centroids of their Voronoi cells. Default: 5. Allowed: 0 to 100"""
    angle: Quantity
    """angle by which the lattice is rotated relative to the body, anticlockwise about the origin, in 3D about the z axis. Shapes, layers and sets are not rotated [degrees]. Default: 0. Allowed: -360 to 360"""
    horizon_ratio: float
    """horizon / spacing; if spacings differ, horizon / geometric mean of the spacings. Default: 3.015. Allowed: 1 to 1000; in 3D to 100; with model `cpd` to 50 in 2D, to 8 in 3D"""
    thickness: Quantity
    """thickness of the plate, dimension 2 only [m]. Default: 1. Allowed: positive"""
    area: Quantity
    """cross-section of the bar, dimension 1 only [m2]. Default: 1. Allowed: positive"""
    origin: Literal["cell_centres", "nodes"]
    """position of the points relative to the lower corner of the first shape. `'cell_centres'`: half a spacing inside; `'nodes'`: on the corner itself. Default: `'cell_centres'`. Allowed: `'cell_centres'`, `'nodes'`"""
    volumes: Literal["cells", "fractional"]
    """volumes of points. `'cells'`: the whole cell, if its lattice point lies in the body; `'fractional'`: the part of each cell that lies in the body. Default: `'cells'`. Allowed: `'cells'`, `'fractional'`; `fractional` with model `bond`"""
    perturbation: float
    """largest random shift of a point along each of the lattice's axes; points of layers are not moved [spacings]. Default: 0. Allowed: 0 to 0.49"""
    cell_perturbation: float
    """largest random shift of the corners of cells inside the body along each of the lattice's axes; a point is at the centroid of its cell and has the volume of the cell [spacings]. Default: 0. Allowed: 0 to 0.249; model `bond`"""
    seed: int
    """seed of the random shifts and positions; the same seed gives the same points. Default: 1. Allowed: whole number from 0"""
    def add_shape(self, *, add: Literal["box", "disk", "ellipse", "cylinder", "sphere", "polygon", "image", "stl"] = ..., subtract: Literal["box", "disk", "ellipse", "cylinder", "sphere", "polygon", "image", "stl"] = ..., name: str = ..., cuts_bonds: bool = ..., min: List = ..., max: List = ..., centre: List = ..., radius: Quantity = ..., radii: List = ..., angle: Quantity = ..., axis: List = ..., length: Quantity = ..., vertices: List = ..., file: str = ..., scale: Quantity = ..., grey: List = ..., translate: List = ...) -> LatticeShape: ...
    shape: Array[LatticeShape]
    """tables: shapes that make up the body. at least one is required"""
    def add_refine(self, *, shape: Literal["box", "disk", "ellipse", "cylinder", "sphere", "polygon", "image", "stl"] = ..., spacing: Quantity = ..., growth: float = ..., min: List = ..., max: List = ..., centre: List = ..., radius: Quantity = ..., radii: List = ..., angle: Quantity = ..., axis: List = ..., length: Quantity = ..., vertices: List = ..., file: str = ..., scale: Quantity = ..., grey: List = ..., translate: List = ...) -> LatticeRefine: ...
    refine: Array[LatticeRefine]
    """tables: regions in which points of blue noise, and with them their horizons, are finer. Default: none"""
    def add_layer(self, *, name: str = ..., side: Literal["x-", "x+", "y-", "y+", "z-", "z+"] = ..., thickness: int = ..., where: str = ...) -> LatticeLayer: ...
    layer: Array[LatticeLayer]
    """tables: points outside the body. Default: none"""

class Points(Table):
    file: str
    """file of points as text with commas or blanks, or a mesh, chosen by the ending of the name (.msh, .inp, .vtu, .vtk, .exo, .e, .ex2, .med); its path is relative to the case file's folder. required. Allowed: an existing file"""
    horizon: Quantity | dict[str, Any]
    """horizon, the same for every point; or `{ ratio = 3.015 }`, a horizon per point of 3.015 times its size, for model `bond` and points of different sizes [m]. required. Allowed: positive, or `{ ratio = … }`; at least the mean spacing; at most as many mean spacings as `lattice.horizon_ratio` allows"""
    length_unit: Quantity
    """unit of the coordinates in the file; its volumes are in this unit cubed [m]. Default: 1, or the `length` of `[units]`. Allowed: positive"""
    neighbours: str
    """file with the neighbours of the points and the shares of their volumes that count; its path is relative to the case file's folder. For model `bond`. Default: all points within the horizon. Allowed: an existing file"""
    at: Literal["elements", "nodes"]
    """for a mesh: where the points are. `'elements'`: at the centroid of each element, with the volume of the element; `'nodes'`: at each node, with its share of the volumes of the elements around it. Default: `'elements'`. Allowed: `'elements'`, `'nodes'`"""
    cut_bonds: bool
    """for a mesh: whether the boundary of the elements cuts the bonds that leave the body. Default: true. Allowed: true, false"""
    thickness: Quantity
    """thickness of the plate, dimension 2 only [m]. Default: 1. Allowed: positive"""
    area: Quantity
    """cross-section of the bar, dimension 1 only [m2]. Default: 1. Allowed: positive"""

class SetShapeBox(Table):
    min: List
    """box, image: lower corner [m]. required. Allowed: a number per dimension; below `max`"""
    max: List
    """box, image: upper corner [m]. required. Allowed: a number per dimension"""

class SetShapeDisk(Table):
    centre: List
    """disk, ellipse, cylinder, sphere: centre [m]. required. Allowed: a number per dimension"""
    radius: Quantity
    """disk, cylinder, sphere: radius [m]. required. Allowed: positive"""

class SetShapeEllipse(Table):
    centre: List
    """disk, ellipse, cylinder, sphere: centre [m]. required. Allowed: a number per dimension"""
    radii: List
    """ellipse: radii along its two axes [m]. required. Allowed: a number per dimension; positive"""
    angle: Quantity
    """ellipse: angle from x to the axis of the first radius, anticlockwise [degrees]. Default: 0. Allowed: -360 to 360"""

class SetShapeCylinder(Table):
    centre: List
    """disk, ellipse, cylinder, sphere: centre [m]. required. Allowed: a number per dimension"""
    axis: List
    """cylinder: direction of its axis. Default: `[0, 0, 1]`. Allowed: a number per dimension; not zero"""
    radius: Quantity
    """disk, cylinder, sphere: radius [m]. required. Allowed: positive"""
    length: Quantity
    """cylinder: length along its axis, half to each side of the centre [m]. Default: infinite. Allowed: positive; finite if it is added"""

class SetShapePolygon(Table):
    vertices: List
    """polygon: corners in order. The last corner is joined to the first [m]. exactly one of `vertices`, `file`. Allowed: 3 or more pairs `[x, y]`; around an area"""
    file: str
    """polygon (instead of `vertices`): file with corners x, y; image: PNG or TIFF picture; stl: STL surface. The path is relative to the case file's folder. exactly one of `vertices`, `file`. Allowed: an existing file"""
    scale: Quantity
    """polygon, stl: length of 1 in the file [m]. Default: 1, or the `length` of `[units]`. Allowed: positive"""

class SetShapeImage(Table):
    file: str
    """polygon (instead of `vertices`): file with corners x, y; image: PNG or TIFF picture; stl: STL surface. The path is relative to the case file's folder. required. Allowed: an existing file"""
    min: List
    """box, image: lower corner [m]. required. Allowed: a number per dimension; below `max`"""
    max: List
    """box, image: upper corner [m]. required. Allowed: a number per dimension"""
    grey: List
    """image: smallest and largest grey value of the pixels inside the shape, 0 (black) to 255, or to 65535 in files with 16 bits. required. Allowed: two numbers, the second not below the first"""

class SetShapeStl(Table):
    file: str
    """polygon (instead of `vertices`): file with corners x, y; image: PNG or TIFF picture; stl: STL surface. The path is relative to the case file's folder. required. Allowed: an existing file"""
    scale: Quantity
    """polygon, stl: length of 1 in the file [m]. Default: 1, or the `length` of `[units]`. Allowed: positive"""
    translate: List
    """stl: shift after the scaling [m]. Default: `[0.0, 0.0]`. Allowed: a number per dimension"""

class SetShape(Table):
    box: Inner[SetShapeBox]
    disk: Inner[SetShapeDisk]
    ellipse: Inner[SetShapeEllipse]
    cylinder: Inner[SetShapeCylinder]
    sphere: Inner[SetShapeDisk]
    polygon: Inner[SetShapePolygon]
    image: Inner[SetShapeImage]
    stl: Inner[SetShapeStl]

class Set(Table):
    name: str
    """name of the set. required. Allowed: letters, digits, `_`, `-`; at most 100 characters; no other set or layer has it"""
    where: str
    """expression; the set has the points where it is not zero. this or `shape` is required. Allowed: an expression of place"""
    shape: Inner[SetShape]
    """shape; the set has the points in it. Its keys are those of `[[lattice.shape]]`: `{ box = { min = [0, 0], max = [1, 1] } }`. this or `where` is required. Allowed: `'box'`, `'disk'`, `'ellipse'`, `'cylinder'`, `'sphere'`, `'polygon'`, `'image'`, `'stl'`"""

class Crack(Table):
    outline: List
    """2D: corners of a closed polygon. Its sides cut bonds. The last corner is joined to the first [m]. Default: this, or `from` and `to`, in 2D. Allowed: 3 or more pairs `[x, y]`"""
    from_: List
    """2D: one end [m]. required in 2D without `outline`. Allowed: a number per dimension"""
    to: List
    """2D: the other end [m]. required in 2D without `outline`. Allowed: a number per dimension; not `from`"""
    vertices: List
    """3D: corners of a polygon in order. The last corner is joined to the first [m]. required in 3D. Allowed: 3 or more `[x, y, z]`; in one plane (to 10⁻⁹ of the extent) and around an area; edges must not cross or touch"""

class Quadrature(Table):
    form: Literal["collocation", "energy", "printed"]
    """model `lps`. `'collocation'`: forces at points by a quadrature that is exact for linear displacements up to the surface; they have no potential. `'energy'`: forces of an energy, with a symmetric tangent and all modes and loads of the other models (mode `path`: with damage by release). `'printed'`: forces of [FCBM] (A-8), for comparisons only; they have no potential where neighbourhoods differ, and need `solver.operator = 'fft'` in mode `dynamics` with `scheme = 'verlet'`. Default: `'collocation'`. Allowed: `'collocation'`, `'energy'`, `'printed'`"""
    volume_correction: Literal["none", "linear", "exact", "exact_centroids"]
    """share of a neighbour's volume that counts near the horizon. `'none'`: all of it; `'linear'`: linear over half a spacing to either side; `'exact'`: the part of its cell within the horizon; `'exact_centroids'`: the same, with the bond's length and influence taken at that part's centroid. The last two are for whole cells of a lattice, whose corners `cell_perturbation` may shift. Default: `'none'`. Allowed: `'none'`, `'linear'`, `'exact'`, `'exact_centroids'`"""
    horizon_shape: Literal["ball", "box", "diamond"]
    """shape of the neighbourhood. A point interacts with the points within the horizon, by a measure of their distance. `'ball'`: its length; `'box'`: its largest component along the lattice's axes; `'diamond'`: the sum of these components. Boxes and diamonds are stiffer along some directions than along others: moduli are means over all directions. Default: `'ball'`. Allowed: `'ball'`, `'box'`, `'diamond'`"""
    surface_correction: Literal["none", "volume", "energy"]
    """factor that restores the stiffness of points whose neighbourhood is cut by a surface. `'none'`: no factor; `'volume'`: from the volume of the neighbourhood; `'energy'`: from the energy of simple deformations. Default: `'none'`. Allowed: `'none'`, `'volume'`, `'energy'`"""
    weights: Literal["mean", "bulk"]
    """model `cpd`: weights of interactions near surfaces. `'mean'`: from the mean of their points' effective volumes; `'bulk'`: as in the bulk everywhere. Default: `'mean'`. Allowed: `'mean'`, `'bulk'`"""
    degree: int
    """model `lps` by collocation: degree of the polynomials for which the quadrature is exact. Default: 5. Allowed: whole number from 4"""
    traction_form: Literal["full", "paper"]
    """model `lps` by collocation: part of the displacements' continuation beyond the boundary that is used. `'full'`: all of it, which is exact for linear fields on every grid; `'paper'`: the part that [LPS] eq. 4.6 keeps. Default: `'full'`. Allowed: `'full'`, `'paper'`"""
    normals: Literal["numerical", "exact"]
    """model `lps` by collocation: normals of surfaces. `'numerical'`: from the neighbourhoods; `'exact'`: from the shapes' faces, at points that have one face and all of their bonds. Default: `'numerical'`. Allowed: `'numerical'`, `'exact'`"""

class MaterialDamage(Table):
    law: Literal["none", "critical_stretch", "tanh", "tanh_continuous", "linear", "exponential", "blended", "bilinear", "cornelissen", "table", "energy_density"]
    """`'none'`: no damage, and the other keys of the table have no effect; `'critical_stretch'`: a bond is undamaged up to `critical` and then broken; `'tanh'`: softening from `onset` to `critical` as published in [ADAPT], with jumps of (1 − tanh `rate`)/2 at both ends; `'tanh_continuous'`: the same law, rescaled to have no jumps; `'linear'`: the force falls linearly from `onset` to zero at `critical`; `'exponential'`: it falls exponentially, without a jump at `critical`; `'blended'`: it rises on a lower slope from `onset` to `peak`, and then falls linearly; `'bilinear'`: the force over the opening of the bond falls to a third at 2/9 of `critical`, and then to zero, as concrete does [Petersson 1981]; `'cornelissen'`: it follows the curve of concrete of [Cornelissen et al. 1986]; `'table'`: the force is the curve of `stretches` and `forces`; `'energy_density'`: a point fails at once and irreversibly where its energy density exceeds `fracture_energy` / (2 δ); this law is for `kinematics = 'linear'`, and with `solver.operator = 'fft'` for all models. Default: `'none'`. Allowed: `'none'`, `'critical_stretch'`, `'tanh'`, `'tanh_continuous'`, `'linear'`, `'exponential'`, `'blended'`, `'bilinear'`, `'cornelissen'`, `'table'`, `'energy_density'`"""
    fracture_energy: Quantity
    """$G_c$ of a plane crack, the mean over its directions on this lattice; `critical` follows from it. `cpd` with `drive = 'stretch'` accepts it at horizon ratios up to 12 in 2D, 3.2 in 3D [J/m2]. Default: none. Allowed: positive"""
    fracture_toughness: Quantity
    """$K_{Ic}$, can be given instead of `fracture_energy`: $G_c = K_{Ic}^2/E'$, with $E' = E$ in plane stress (and with `cpd` in 2D) and $E/(1 - \\nu^2)$ in plane strain and 3D, with the moduli of the model [Pa*sqrt(m)]. Default: none. Allowed: positive"""
    strength: Quantity
    """$f_t$ of the body: the largest stress that the lattice bears under uniaxial tension, the mean over directions (theory); `onset` follows from it, for `blended` the `peak`, for `critical_stretch` the value of `critical`. `cpd` accepts it at horizon ratios up to 12 in 2D, in 3D only at smaller ones than 3.2, where the computation takes less than minutes [Pa]. Default: none. Allowed: positive"""
    strength_surface: Literal["none", "rankine", "drucker_prager", "mohr_coulomb"]
    """stresses at which a body without flaws fails, through `strength` under uniaxial tension (theory). `'none'`: one stretch for all stresses; `'rankine'`: the largest principal stress; `'drucker_prager'` and `'mohr_coulomb'`: also through `compressive_strength`. Bonds then fail by what their loss would set free. Default: `'none'`. Allowed: `'none'`, `'rankine'`, `'drucker_prager'`, `'mohr_coulomb'`"""
    compressive_strength: Quantity
    """$f_c$, uniaxial, for `drucker_prager` and `mohr_coulomb` [Pa]. Default: none. Allowed: positive; above `strength`"""
    biaxial_strength: Quantity
    """$f_b$ under equal tension in two directions, in the place of `compressive_strength`, for `drucker_prager` [Pa]. Default: none. Allowed: positive; above half of `strength`"""
    strength_factor: List
    """least and largest factor by which the surface may change the `onset` of a bond; the largest is at most the one at which a bond of the same work is brittle. Default: `[0.2, 100.0]`. Allowed: two numbers, the second not below the first; 0.01 to 1, and 1 to 100"""
    critical: Expression
    """stretch $s_c$ at which a bond breaks [1]. this, `fracture_energy` or `fracture_toughness` is required with a law. Allowed: 1e-9 to 1000, or an expression of `horizon` and `spacing`"""
    onset: Expression
    """laws that soften: stretch $s_m$ beyond which a bond loses stiffness [1]. required without `strength`; with `fracture_energy` half the stretch of a brittle bond of that energy, for `blended` a quarter. Allowed: 1e-9 to 1000, or an expression of `horizon` and `spacing`; below `critical`; `bilinear` below a third of it, `cornelissen` below 0.1437 of it"""
    peak: Expression
    """`blended`: stretch $s_p$ at which the force is largest [1]. required without `strength`; if `strength`, `onset` and `peak` are all missing, the largest force is half that of a brittle bond of that `fracture_energy`. Allowed: 1e-9 to 1000, or an expression of `horizon` and `spacing`; from `onset` to below `critical`"""
    hardening: Quantity
    """`blended`: slope of the force between `onset` and `peak`, relative to that of the undamaged bond [1]. Default: 0.5. Allowed: 0 to 0.99"""
    rate: Quantity
    """tanh laws: $\\beta$; a larger value concentrates the softening midway between the two stretches. `exponential`: a larger value makes the force fall more steeply at first [1]. Default: 3. Allowed: 0.1 to 50"""
    stretches: List
    """`table`: stretches, ascending. The first one ends the elastic part. At the last one the bond breaks [1]. required with law `table`. Allowed: list of numbers; 1e-9 to 1000"""
    forces: List
    """`table`: force of a bond at each of the `stretches`, divided by its constant $c$, and linear in between. So the first force equals the first stretch. Force over stretch must not grow. The last force may be 0 [1]. required with law `table`. Allowed: list of numbers"""
    drive: Literal["stretch", "release"]
    """`cpd`, `state`, and `lps` as an energy: what drives the damage of a bond. `'stretch'`: its stretch; `'release'`: what its loss would set free with all that depends on it, as an equivalent stretch that the law takes. `state` has `'release'` alone. Default: `'release'` with `state`, and with `fracture_energy` or `fracture_toughness`; otherwise `'stretch'`. Allowed: `'stretch'`, `'release'`; the same for all materials of a body"""
    struts: Literal["keep", "cut"]
    """model `bond`: what becomes of struts, bonds that still join the two faces of an open crack. `'keep'`: their stretch alone decides; `'cut'`: they fail with the bonds around them. Default: `'keep'`. Allowed: `'keep'`, `'cut'`; the same for all materials of a body"""
    compression: Literal["lost", "kept"]
    """model `bond`: whether damaged bonds bear compression. `'lost'`: as little as tension; `'kept'`: as undamaged ones. Default: `'lost'`. Allowed: `'lost'`, `'kept'`; the same for all materials of a body"""
    no_fail: List
    """sets of points whose bonds stay elastic at any stretch, including bonds to points outside the sets. Default: none. Allowed: list of names of sets and layers"""

class MaterialFibre(Table):
    angle: Quantity
    """2D: angle of the fibres against the x axis, towards y [degrees]. required in 2D. Allowed: -360 to 360"""
    direction: List
    """3D: direction of the fibres, a vector of any length [1]. required in 3D. Allowed: a number per dimension; not all zero"""
    transverse_modulus: Quantity
    """Young's modulus $E_2$ across the fibres; `youngs_modulus` is $E_1$, along them [Pa]. required. Allowed: positive"""
    shear_modulus: Quantity
    """$G$ in planes that contain the fibres. Poisson's ratio follows from it [Pa]. Default: $\\sqrt{E_1E_2}/(2 + 2\\nu)$ with the $\\nu$ of isotropic bonds, 1/3 or 1/4. Allowed: positive; such that no bond has a negative constant"""
    transverse_critical: Quantity
    """`critical` of bonds across the fibres. `critical` of `[material.damage]` then holds along the fibres. In between, `critical` varies with the square of the cosine, and `onset` in proportion to it [1]. Default: as along the fibres. Allowed: 1e-9 to 1000"""

class MaterialScatter(Table):
    of: Literal["stiffness", "strength"]
    """what the factor multiplies. `'stiffness'`: the constants of bonds, triangles and tetrahedra; `'strength'`: the stretches of the law of damage. required. Allowed: `'stiffness'`, `'strength'`"""
    factor: Expression
    """the factor at each point, instead of a random one. The factor of a bond is the mean of its ends [1]. Default: random. Allowed: number or expression of place; from 1e-6 to 1e6 at each point"""
    distribution: Literal["weibull"]
    """distribution of the factor, whose mean is 1. Default: `'weibull'`. Allowed: `'weibull'`"""
    weibull_modulus: Quantity
    """shape $m$; a larger value gives less scatter [1]. required without `factor`. Allowed: 1 to 1000"""
    correlation_length: Quantity
    """length $\\ell$ over which the field changes; 0: the points have independent values [m]. Default: 0. Allowed: 0 or positive"""
    seed: int
    """seed of the field; the same seed and position give the same value, whatever else the case contains. Default: 1. Allowed: whole number from 0"""

class Material(Table):
    model: Literal["bond", "cpd", "state", "lps", "green_bond", "correspondence"]
    """`'bond'`: bond-based peridynamics, whose Poisson ratio is 1/4 (3D and plane strain) or 1/3 (plane stress); `'cpd'`: continuum-kinematics-inspired peridynamics with one-, two- and three-neighbour interactions, dimension 2 and 3; `'state'`: the ordinary state-based solid of any Poisson ratio, at any deformation, dimension 2 and 3; `'lps'`: the linear peridynamic solid of any Poisson ratio, by collocation or as an energy, for small displacements, dimension 2 and 3; `'green_bond'`: bonds that stretch by their squared lengths, at any deformation, like `bond` at small strains; `'correspondence'`: a correspondence material of St. Venant and Kirchhoff of any Poisson ratio, at any deformation, dimension 2 and 3. The last two need `solver.operator = 'fft'`. Default: `'bond'`. Allowed: `'bond'`, `'cpd'`, `'state'`, `'lps'`, `'green_bond'`, `'correspondence'`"""
    potential: Literal["harmonic"]
    """potential of undamaged bonds, a function of their stretch; a damage law uses it below its onset. Default: `'harmonic'`. Allowed: `'harmonic'`"""
    plane: Literal["stress", "strain"]
    """plane stress or plane strain, dimension 2 only (`cpd` in 2D is purely two-dimensional and has neither). Default: `'stress'`. Allowed: `'stress'`, `'strain'`"""
    kinematics: Literal["finite", "linear"]
    """stretch of a `bond`. `'finite'`: from its length, for any deformation; `'linear'`: from the displacements along it, for small displacements, so that forces are linear. `'linear'` is only for `potential = 'harmonic'`, damage by `energy_density`, and no eigenstrains. `lps` is always linear. Default: `'finite'`. Allowed: `'finite'`, `'linear'`"""
    influence: Literal["constant", "piecewise_constant", "linear", "cubic", "quintic", "septic", "gaussian", "inverse"]
    """influence function $\\omega(x)$ with $x = r/\\delta$. `'constant'`: 1; `'piecewise_constant'`: 1, and 0 beyond the horizon; `'linear'`: $1 - x$; `'cubic'`: $1 - 3x^2 + 2x^3$; `'quintic'`: $1 - 10x^3 + 15x^4 - 6x^5$; `'septic'`: $1 - 35x^4 + 84x^5 - 70x^6 + 20x^7$; `'gaussian'`: $e^{-x^2}$; `'inverse'`: $1/x$. The first six are those of [GPMB]. The force density of a bond is $c\\,\\omega s$; constants, moduli and fracture energy account for it. `cpd`: a triangle or tetrahedron has the product of its sides' functions, and the constants are those of the lattice. `state`, and `lps` as an energy: the kernel K(r); `lps` by collocation: only `inverse`. Default: `'constant'`; `'inverse'` with `state` and `lps`. Allowed: `'constant'`, `'piecewise_constant'`, `'linear'`, `'cubic'`, `'quintic'`, `'septic'`, `'gaussian'`, `'inverse'`"""
    youngs_modulus: Quantity
    """Young's modulus, for all models [Pa]. exactly one of `youngs_modulus`, `micromodulus`, `c1`. Allowed: positive"""
    micromodulus: Quantity
    """`bond`: bond constant c of the pairwise force c·stretch [N/m6]. exactly one of `youngs_modulus`, `micromodulus`, `c1`. Allowed: positive"""
    poisson_ratio: float
    """Poisson's ratio, for `cpd`, `lps` and `correspondence` with `youngs_modulus`. required with `youngs_modulus`. Allowed: -1 to 1; `lps`, `correspondence`: to 0.5; `cpd`: in 3D to 0.5; these limits are excluded; `cpd` with damage: at least 0, by `drive = 'stretch'` at least 1/3 (2D) or 1/4 (3D)"""
    stabilisation: float
    """`correspondence`: stiffness of the springs against zero-energy modes, which do not change the deformation gradients; relative to bonds of the same bulk modulus. Default: 0.5. Allowed: positive"""
    c1: Quantity
    """`cpd`: one-neighbour constant [N/m6]. exactly one of `youngs_modulus`, `micromodulus`, `c1`. Allowed: positive"""
    c2: Quantity
    """`cpd`: two-neighbour constant; in 3D it may also be given with `youngs_modulus`, in 2D it follows from it [N/m10]. Default: 0. Allowed: any number; a negative one is refused with damage by `stretch`, and where it makes the body unstable at rest"""
    c3: Quantity
    """`cpd`: three-neighbour constant, 3D; it follows from `youngs_modulus` if that is given [N/m14]. Default: 0. Allowed: any number; for a negative one see `c2`"""
    calibration: Literal["lattice", "continuum"]
    """with `youngs_modulus`: how the constants follow from the moduli. `'lattice'`: by the sums of this lattice with their corrections (`bond`: in the mean over all directions); `'continuum'`: by integrals. Default: `'lattice'` with `cpd`, `'continuum'` with `bond`. Allowed: `'lattice'`, `'continuum'`"""
    thermal_expansion: Quantity
    """coefficient α of linear expansion, for `[temperature]` [1/K]. Default: none. Allowed: -1 to 1"""
    density: Quantity
    """mass density, for gravity and mode `dynamics`. Dynamic relaxation has a pseudo density of its own [kg/m3]. Default: none. Allowed: positive"""
    damage: Inner[MaterialDamage]
    """table `[material.damage]`. Default: no damage"""
    fibre: Inner[MaterialFibre]
    """table `[material.fibre]`: moduli and stretches that depend on the direction of the bond. Default: none"""
    def add_scatter(self, *, of: Literal["stiffness", "strength"] = ..., factor: Expression = ..., distribution: Literal["weibull"] = ..., weibull_modulus: Quantity = ..., correlation_length: Quantity = ..., seed: int = ...) -> MaterialScatter: ...
    scatter: Array[MaterialScatter]
    """tables `[[material.scatter]]`: factors that vary from point to point, random or given. Default: none"""

class Region(Table):
    set: str
    """set of the points that have this material. required. Allowed: name of a set or layer; no region shares points with another"""
    material: Inner[Material]
    """table `[region.material]`, with the keys of [`material]`. required"""

class Interface(Table):
    between: List
    """the two materials that meet at the interface. Default: all pairs that no other `[[interface]]` names. Allowed: two sets of regions; `'material'` for the points in none"""
    rule: Literal["harmonic", "arithmetic", "weaker"]
    """rule for the constants of a bond or other interaction between points of the two materials. `'harmonic'`: the harmonic mean of the values of its points; `'arithmetic'`: their arithmetic mean; `'weaker'`: the smallest value. The stretches of damage laws of the same kind follow by the same rule. Default: `'harmonic'`. Allowed: `'harmonic'`, `'arithmetic'`, `'weaker'`"""
    material: Inner[Material]
    """table `[interface.material]`, with the keys of [`material]` except `density` and `scatter`: constants and damage of the interface. Default: none: the `rule` holds"""

class Support(Table):
    set: str
    """set that is held or moved. required. Allowed: name of a set or layer"""
    displacement: List
    """prescribed displacement per component [m]. required. Allowed: number, expression of place and `load` (mode `dynamics`: `t`), or `'free'`"""

class Rigid(Table):
    set: str
    """set whose points move as one rigid body. required. Allowed: name of a set or layer"""
    centre: List
    """reference position of the centre of rotation, about which moments are reported, too [m]. Default: centre of the set's volume. Allowed: a number per dimension"""
    displacement: List
    """displacement of the centre, per component [m]. Default: `['free', 'free']`. Allowed: number, expression of `load` alone, or `'free'`"""
    rotation: List
    """rotation vector: in 2D one component, about z [rad]. Default: `['free']`. Allowed: number, expression of `load` alone, or `'free'`"""

class Roller(Table):
    set: str
    """set of points, each of which can slide at right angles to the normal. exactly one of `set`, `at`. Allowed: name of a set or layer"""
    at: List
    """position at which a roller touches the body. It holds the mean displacement of the points around, with weights that give the displacement at this position [m]. exactly one of `set`, `at`. Allowed: a number per dimension"""
    to: List
    """3D: other end of the line along which the roller touches the body [m]. Default: a point. Allowed: a number per dimension"""
    name: str
    """with `at`: name under which its reaction is reported. required with `at`. Allowed: letters, digits, `_`, `-`; at most 100 characters"""
    normal: List
    """direction that is held, a vector of any length. required. Allowed: a number per dimension; not all zero"""
    displacement: Expression
    """displacement along the normal; `'free'`: unknown, but the same for all points of the set (a platen without friction that does not rotate) [m]. Default: `'0'`. Allowed: number, or expression of place and `load`, or `'free'`"""

class ConstraintTerm(Table):
    set: str
    """set whose mean displacement is taken. required. Allowed: name of a set or layer"""
    weights: List
    """weights of the mean displacement's components. required. Allowed: a number per dimension"""

class Constraint(Table):
    name: str
    """name under which its force is reported. required. Allowed: letters, digits, `_`, `-`; at most 100 characters"""
    displacement: Expression
    """sum of the weighted mean displacements of all terms [m]. Default: `'0'`. Allowed: number, or expression of `load` alone"""
    def add_term(self, *, set: str = ..., weights: List = ...) -> ConstraintTerm: ...
    term: Array[ConstraintTerm]
    """tables: the terms. required"""

class Symmetry(Table):
    axis: Literal["x", "y", "z"]
    """axis normal to the plane. required. Allowed: `'x'`, `'y'`, `'z'`, as the dimension has them"""
    at: Quantity
    """coordinate of the plane on the axis, half a spacing before the first points [m]. Default: 0. Allowed: a number"""

class Period(Table):
    axis: Literal["x", "y", "z"]
    """axis along which the body repeats. required. Allowed: `'x'`, `'y'`, `'z'`, as the dimension has them"""
    from_: Quantity
    """one side of the cell [m]. required. Allowed: a number"""
    to: Quantity
    """the other side [m]. required. Allowed: a number; above `from`"""
    gradient: List
    """mean displacement gradient ∂u/∂(axis), per component; `'free'`: the cell has no mean stress there [1]. Default: `['0', '0']`. Allowed: number, expression of `load` (`t`) alone, or `'free'`"""

class Load(Table):
    set: str
    """set that is loaded. required, except for `gravity`, which then acts on the whole body, and for `traction` and `pressure` with a `side`. Allowed: name of a set or layer"""
    body_force: List
    """force density per component [N/m3]. exactly one of `body_force`, `total_force`, `gravity`, `traction`, `pressure`, `stress`. Allowed: number or expression of place and `load` (mode `dynamics`: `t`)"""
    total_force: List
    """force on the whole set per component, distributed in proportion to the volumes of the points [N]. exactly one of `body_force`, `total_force`, `gravity`, `traction`, `pressure`, `stress`. Allowed: number or expression of `load` (`t`) alone"""
    gravity: List
    """acceleration per component. It is multiplied by `material.density`. Layers have no weight unless `set` names them [m/s2]. exactly one of `body_force`, `total_force`, `gravity`, `traction`, `pressure`, `stress`. Allowed: number or expression of place and `load` (mode `dynamics`: `t`)"""
    traction: List
    """force per area per component on a flat part of the boundary, or on facets of a mesh. Its direction is fixed. For a lattice or a mesh [Pa]. exactly one of `body_force`, `total_force`, `gravity`, `traction`, `pressure`, `stress`. Allowed: number or expression of place and `load` (mode `dynamics`: `t`)"""
    pressure: Expression
    """pressure on the exposed faces of the cells of the set's points, or of a side. It follows the faces as they deform. Positive values push. For a lattice or a mesh [Pa]. exactly one of `body_force`, `total_force`, `gravity`, `traction`, `pressure`, `stress`. Allowed: number or expression of place and `load` (mode `dynamics`: `t`)"""
    stress: List
    """model `lps`: stress outside the surface, [xx, yy, xy] or [xx, yy, zz, xy, yz, xz]. It loads the surface with the traction stress · outward normal [Pa]. exactly one of `body_force`, `total_force`, `gravity`, `traction`, `pressure`, `stress`. Allowed: numbers or expressions of place and `load` (mode `dynamics`: `t`)"""
    boundary: str
    """model `lps`: `name` of the `[[lattice.shape]]` whose boundary is loaded. Default: `''`"""
    side: Literal["x-", "x+", "y-", "y+", "z-", "z+"]
    """`traction`, `pressure`: the body's outermost plane of points on a side, named as in `[[lattice.layer]]`. `traction`, `pressure`: this or a `set` is required; the set of a traction lies in one plane of points. Allowed: `'x-'`, `'x+'`, and so on for y and z"""
    depth: Literal["row", "horizon", "surface"]
    """`traction`: where it acts. `'row'`: on the outermost row of points; `'horizon'`: spread evenly over a horizon below the boundary; `'surface'`: on the surface itself, only and always with model `lps`. Default: `'row'`. Allowed: `'row'`, `'horizon'`, `'surface'`"""

class Foundation(Table):
    name: str
    """name under which its force is reported. required. Allowed: letters, digits, `_`, `-`; at most 100 characters"""
    set: str
    """set on the foundation; with `modulus` one plane of points on the boundary. required, except for `modulus` with a `side`. Allowed: name of a set or layer"""
    side: Literal["x-", "x+", "y-", "y+", "z-", "z+"]
    """`modulus`: the body's outermost plane of points on a side, or the side that is meant if the set lies on several. Default: none. Allowed: `'x-'`, `'x+'`, and so on for y and z"""
    modulus: List
    """traction per displacement along each axis, on a flat part of the boundary; on a lattice only [N/m3]. exactly one of `modulus`, `stiffness`. Allowed: numbers from 0, not all 0"""
    stiffness: List
    """stiffness of all springs of the set together along each axis, distributed in proportion to the volume [N/m]. exactly one of `modulus`, `stiffness`. Allowed: numbers from 0, not all 0"""
    displacement: List
    """displacement of the ground, per component [m]. Default: `['0', '0']`. Allowed: number or expression of place and `load` (mode `dynamics`: `t`)"""

class Contact(Table):
    set: str
    """set whose points touch. Default: all points. Allowed: name of a set or layer"""
    with_: str
    """another set, which the points of `set` touch, and not one another. Default: the points of `set` touch one another. Allowed: name of a set or layer"""
    shape: Literal["points", "faces"]
    """what touches. `'points'`: points, for cracks that slip by less than a spacing and for fragments; `'faces'`: points and the faces that join surface points, for surfaces that slide. Default: `'points'`. Allowed: `'points'`, `'faces'`"""
    distance: Quantity
    """distance at which two points touch [m]. Default: the mean of the two points' sizes, on a lattice the spacing. Allowed: positive"""
    reach: Quantity
    """distance in the undeformed body up to which points see one another beyond planes of symmetry and periods and on other ranks; nothing else needs it. A state in which others would touch is refused [m]. Default: the horizon. Allowed: positive"""
    stiffness: float
    """stiffness over that of the bar of material between two points. Default: 1. Allowed: 0.001 to 1000"""
    depth: float
    """largest depth of the contact over its distance; the force grows without limit towards it. Default: 0.25. Allowed: 0.01 to 0.5"""
    softness: float
    """strain of the gap over which the stiffness sets in; at most a tenth of the strains of interest. Default: 1e-4. Allowed: 1e-9 to 0.25"""
    friction: float
    """coefficient of Coulomb's friction. Default: 0. Allowed: 0 to 1000"""
    tangential_stiffness: float
    """stiffness of contacts that stick, relative to `stiffness`. Default: 0.5. Allowed: 0.001 to 1000"""

class Obstacle(Table):
    name: str
    """name under which its force is reported. required. Allowed: letters, digits, `_`, `-`; at most 100 characters"""
    set: str
    """set of the points that it can touch. Default: all points. Allowed: name of a set or layer"""
    shape: Literal["plane", "cylinder", "sphere"]
    """shape of its surface: in 1D a plane, in 2D a plane or a cylinder (a disk). required. Allowed: `'plane'`, `'cylinder'`, `'sphere'`"""
    point: List
    """a place on the plane or on the cylinder's axis, or the centre of the sphere; moments are reported about it [m]. required. Allowed: a number per dimension"""
    normal: List
    """`plane`: direction from it towards the body, a vector of any length. required for a plane. Allowed: a number per dimension; not all zero"""
    axis: List
    """`cylinder` in 3D: direction of its axis, a vector of any length. required for a cylinder in 3D. Allowed: a number per dimension; not all zero"""
    radius: Quantity
    """`cylinder`, `sphere`: radius, at least two spacings [m]. required for these. Allowed: positive"""
    inside: bool
    """`cylinder`, `sphere`: the body is inside of it. Default: false. Allowed: true, false"""
    displacement: List
    """displacement of the obstacle, per component; `'free'` for the one along which a force drives it [m]. Default: `['0', '0']`. Allowed: number or expression of `load` (`t`) alone, or `'free'`"""
    force: Expression
    """force that drives the obstacle along the component of its displacement that is `'free'`, and that it exerts on the body [N]. none; required if a component is `'free'`. Allowed: number, or expression of `load` alone"""
    stiffness: float
    """stiffness of the contact relative to that of the point's cell, Young's modulus times its section over half a spacing. Default: 1. Allowed: positive"""
    depth: float
    """depth that no point may reach, relative to half a spacing. Default: 0.25. Allowed: 0.001 to 0.999"""
    softness: float
    """depth over which the stiffness sets in, relative to half a spacing. Default: 1e-4. Allowed: 1e-12 to 0.999; below `depth`"""
    friction: float
    """coefficient of Coulomb's friction. Default: 0. Allowed: 0 to 1000"""
    tangential_stiffness: float
    """stiffness of contacts that stick, relative to `stiffness`. Default: 0.5. Allowed: 0.001 to 1000"""

class Eigenstrain(Table):
    set: str
    """set with the strain. Default: all points. Allowed: name of a set or layer"""
    strain: Expression
    """strain that a part would have if it were not held, the same in all directions: its length relative to that in the reference, minus 1 [1]. required. Allowed: number or expression of place and `load` (mode `dynamics`: `t`); above −1"""

class Temperature(Table):
    change: Expression
    """change of the temperature from the reference. With `material.thermal_expansion` all points get the eigenstrain α ΔT [K]. no change; required in the table. Allowed: number or expression of place and `load` (mode `dynamics`: `t`)"""

class Control(Table):
    set: str
    """set whose mean displacement is taken. required. Allowed: name of a set or layer"""
    weights: List
    """weights of the mean displacement's components. The controlled displacement is the sum of the weighted displacements of all these tables. required. Allowed: a number per dimension; not all zero"""

class Initial(Table):
    set: str
    """set of points that begin with these values. Default: all points. Allowed: name of a set or layer"""
    displacement: List
    """displacement at time 0, per component. Where a support prescribes another value, that value is used [m]. Default: `['0', '0']`. Allowed: number or expression of place"""
    velocity: List
    """velocity at time 0, per component, where no support prescribes the displacement [m/s]. Default: `['0', '0']`. Allowed: number or expression of place"""

class Absorbing(Table):
    set: str
    """set of points that absorb. Default: all points. Allowed: name of a set or layer"""
    rate: Expression
    """rate at which velocities decay, in addition to the effect of forces [1/s]. required. Allowed: number or expression of place"""

class Loading(Table):
    steps: int
    """number of equal steps from one entry of the tables to the next, or of a table that is an expression; without a table from 0 to 1. Default: 1. Allowed: 1 to 1000000"""
    table: List | str
    """values of `load` along the path, linear from one to the next. They may rise, fall and stay constant. With `[[control]]`: values of the controlled displacement in m. In mode `dynamics`: pairs of a time in s and the value of `load` at it. `[0, 1]`; required with `[[control]]`. Allowed: at least two numbers, the first 0, or an expression of `step`, 0 at step 0; in mode `dynamics` two or more pairs `[t, value]`, from t = 0 to `end_time`, ascending"""
    table2: List | str
    """likewise for a further load parameter, `load2`. Default: no `load2`. Allowed: at least two numbers, the first 0, or an expression of `step`, 0 at step 0; in mode `dynamics` two or more pairs `[t, value]`, from t = 0 to `end_time`, ascending"""
    table3: List | str
    """likewise for a further load parameter, `load3`. Default: no `load3`. Allowed: at least two numbers, the first 0, or an expression of `step`, 0 at step 0; in mode `dynamics` two or more pairs `[t, value]`, from t = 0 to `end_time`, ascending"""
    table4: List | str
    """likewise for a further load parameter, `load4`. Default: no `load4`. Allowed: at least two numbers, the first 0, or an expression of `step`, 0 at step 0; in mode `dynamics` two or more pairs `[t, value]`, from t = 0 to `end_time`, ascending"""
    adaptive: bool
    """whether a step that does not converge is cut; steps then grow again. Otherwise such a step ends the run. Default: true. Allowed: true, false"""
    smallest_step: float
    """smallest step of the stage (the load factor, without a table). The run ends when it needs a smaller one. Default: 1e-6. Allowed: 1e-12 to 1; at most the first step"""
    largest_step: float
    """largest step of the stage, to which steps may grow. Default: the first step. Allowed: 1e-12 to 1; at least the first step"""
    max_broken_bonds: int
    """mode `newton`: largest number of bonds that may break in one step. A step with more is cut. 0: no limit [bonds]. Default: 0. Allowed: whole number from 0"""
    stop_below: float
    """the run is complete when the largest support reaction falls below this share of its maximum so far, as when a specimen tears. 0: only the end of the load ends the run. Default: 0. Allowed: 0 to 1"""
    event_tolerance: float
    """mode `path`: bonds whose utilisation is within this share of the largest one break together with it. 0: only bonds with equal utilisation. Default: 0.002. Allowed: 0 to 0.5"""
    teeth: int
    """mode `path`: largest number of teeth of the saw-tooth law that replaces a law of damage with smooth softening. Default: 10. Allowed: 1 to 1000"""

class Solver(Table):
    mode: Literal["newton", "relaxation", "adaptive", "arc_length", "path", "dynamics", "fatigue"]
    """`'newton'`: all steps implicit; `'relaxation'`: all steps by dynamic relaxation; `'adaptive'`: implicit steps while no damage grows, relaxation while it does; `'arc_length'`: steps along the equilibrium path, through limit points and bifurcations, without damage; `'path'`: sequentially linear analysis, from one breaking bond to the next; `'dynamics'`: the motion in time, by explicit or implicit steps; `'fatigue'`: cycles of the load, from one bond at the end of its life to the next. Default: `'newton'`. Allowed: `'newton'`, `'relaxation'`, `'adaptive'`, `'arc_length'`, `'path'`, `'dynamics'`, `'fatigue'`"""
    linear: Literal["auto", "cholesky", "pcg", "minres", "gmres", "lu", "bicgstab"]
    """solver of the linear systems (linear-solvers.md). `'auto'`: chooses one, reports why, and takes another one if it fails; `'cholesky'`: direct, for symmetric tangents; `'pcg'`: conjugate gradients, for symmetric tangents; `'minres'`: minimal residuals, for symmetric tangents; `'gmres'`: iterative, for all models; `'lu'`: direct, for tangents that are not symmetric; `'bicgstab'`: iterative, for tangents that are not symmetric. Default: `'auto'`. Allowed: `'auto'`, `'cholesky'`, `'pcg'`, `'minres'`, `'gmres'`, `'lu'`, `'bicgstab'`"""
    preconditioner: Literal["auto", "jacobi", "block_jacobi", "rigid_pieces", "surrogate", "sines", "riluk", "chebyshev", "multigrid", "local_operator"]
    """preconditioner of iterative solvers, not for `'cholesky'` and `'lu'`. Symmetric tangent: `'auto'` means `'rigid_pieces'`, and with a preconditioner that is given `linear = 'auto'` means `'pcg'`; `'sines'` is for points on a lattice along the axes, without constraints and images. Unsymmetric tangent: `'local_operator'`, `'jacobi'` and `'block_jacobi'` are allowed, `'auto'` means `'local_operator'`, and `linear = 'auto'` then means `'gmres'`. Default: `'auto'`. Allowed: `'auto'`, `'jacobi'`, `'block_jacobi'`, `'rigid_pieces'`, `'surrogate'`, `'sines'`, `'riluk'`, `'chebyshev'`, `'multigrid'`, `'local_operator'`"""
    tangent: Literal["auto", "stored", "matrix_free"]
    """`'auto'`: stored for direct solvers; `'stored'`: the tangent's blocks are stored; `'matrix_free'`: they are computed anew in each product, which takes a third of the memory in 3D, for `material.model = 'bond'`, `'state'` and `'lps'` as an energy, without `'cholesky'`, `'riluk'`, `'chebyshev'` and `'multigrid'`. Default: `'auto'`. Allowed: `'auto'`, `'stored'`, `'matrix_free'`"""
    precision: Literal["single", "double"]
    """of matrix-free products of bonds along rows of a lattice inside conjugate gradients. `'single'`: parts of the bonds are rounded to single precision, which nearly halves the time; the residual of every solution is computed in double precision, and iterations go on until it is small enough; `'double'`: nothing is rounded. Default: `'single'`. Allowed: `'single'`, `'double'`"""
    operator: Literal["auto", "bonds", "stencil", "fft"]
    """how forces are summed. `'auto'`: by the faster way, where possible `fft` for motions by explicit steps of `material.kinematics = 'linear'`, and of `lps` as an energy, with a horizon of 2.5 spacings or more; `'bonds'`: bond by bond, for bonds and states along rows of a lattice where consecutive points have alike bonds, for whole rows at once; `'stencil'`: like `'bonds'`, refused if less than half of the bonds are in such rows; `'fft'`: by fast Fourier transforms, which store no bonds and take the same time whatever the horizon, for one material on points of a lattice with equal volumes, without a `surface_correction`. All give the same results to round-off. Models `green_bond` and `correspondence`, and `lps` as printed, have only `fft`. Default: `'bonds'`. Allowed: `'auto'`, `'bonds'`, `'stencil'`, `'fft'`"""
    predictor: Literal["consistent", "none"]
    """state about which the first iteration of a step linearises. `'consistent'`: the old state, spreading the jump of the supports; `'none'`: the state after the jump, as in [CPD]. Default: `'consistent'`. Allowed: `'consistent'`, `'none'`"""
    projection: Literal["auto", "never", "always"]
    """when the tangents of interactions are projected to their positive semidefinite part. `'auto'`: if the exact tangent has negative pivots or the search fails with it; `'never'`: not even then; `'always'`: in every iteration. Default: `'auto'`. Allowed: `'auto'`, `'never'`, `'always'`"""
    relative_tolerance: float
    """relative tolerance of the residual. Default: 1e-10. Allowed: 1e-14 to 0.01"""
    linear_tolerance: float
    """largest relative residual allowed in the linear system of a Newton iteration. Default: 0.001. Allowed: 1e-14 to 0.1"""
    max_iterations: int
    """largest number of iterations of Newton's method in one step. Default: 25. Allowed: 1 to 1000"""
    fragments: Literal["hold", "remove", "stop"]
    """what happens to pieces that come off. `'hold'`: as many of their degrees of freedom are pinned as are needed to prevent free motions; `'remove'`: they leave the equations and stay where they are; `'stop'`: the run ends with outcome `fragmented`. Default: `'hold'`. Allowed: `'hold'`, `'remove'`, `'stop'`; not `'remove'` with eigenstrains or a temperature"""
    elastic_horizon_ratio: float
    """mode `adaptive`: horizon / spacing of an elastic stand-in that replaces the body until damage begins; needs model `bond`, `youngs_modulus` and a damage law. Default: no stand-in. Allowed: 1 to 1000; in 3D to 100"""

class Relaxation(Table):
    steps: int
    """number of equal steps of the *whole* load, or from one entry of `loading.table` to the next; the first step is 1/steps, whatever part of the load the implicit steps have left. Default: `loading.steps`; in mode `adaptive` with damage at least 50. If the table is an expression, which has an entry for each step: 1, in mode `adaptive` with damage at least 50 in all. Allowed: whole number from 1"""
    method: Literal["dynamic", "flow"]
    """`'dynamic'`: dynamic relaxation, a motion with a pseudo inertia; `'flow'`: the flow without inertia, whose directions are solutions of linear systems. Default: `'dynamic'`. Allowed: `'dynamic'`, `'flow'`"""
    flow_tolerance: float
    """method `flow`: largest deviation of a step from the path of the flow, relative to the length of the step. Default: 0.1. Allowed: 0.001 to 0.5"""
    peak_tolerance: float
    """mode `adaptive`: a relaxed step in which the force begins to fall is halved until it is no longer than this share of the whole load; the decision that accepts it names the load factors between which the peak lies. 0: no search. Default: 0. Allowed: 0 to 1"""
    load: Literal["fixed", "moving"]
    """`'fixed'`: the load is constant after the ramp until the body is in equilibrium; `'moving'`: it changes in every iteration. Default: `'fixed'`. Allowed: `'fixed'`, `'moving'`"""
    iterations: int
    """load `moving`: iterations over the whole load, or from one entry of `loading.table` to the next, shared equally among the steps. Default: 10000. Allowed: whole number from 1; a multiple of `steps`"""
    ramp: int
    """load `fixed`: iterations over which supports and loads move to their new values. Default: 100. Allowed: whole number from 1"""
    quiet_iterations: int
    """load `fixed`: iterations without a further bond breaking before a state may be accepted. Default: 50. Allowed: whole number from 0"""
    breaking: Literal["at_equilibrium", "transient"]
    """when damage becomes permanent. `'at_equilibrium'`: only in accepted states, so an overshoot breaks nothing; `'transient'`: in every iteration, as published. Default: `'at_equilibrium'`; `'transient'` if the load is `moving`. Allowed: `'at_equilibrium'`, `'transient'`"""
    damping: Literal["adaptive", "kinetic"]
    """`'adaptive'`: a coefficient from the Rayleigh quotient of the present motion, as published; `'kinetic'`: no damping coefficient, but all motion is stopped whenever the kinetic energy has passed a peak. Default: `'kinetic'`; `'adaptive'` if the load is `moving`. Allowed: `'adaptive'`, `'kinetic'`"""
    mass_factor: float
    """pseudo density relative to the smallest stable one: larger is slower and safer. Default: 2; 1 with adaptive damping. Allowed: 1 to 1e6"""
    max_iterations: int
    """load `fixed`: largest number of iterations after the ramp. A step that needs more fails and is cut. Default: 50000. Allowed: whole number from 1"""
    displacement_tolerance: float
    """load `fixed`: also accepts a state whose displacements changed by less than this in an iteration, ‖Δu‖/‖u‖, as published (10⁻⁹). 0: never. Default: 0. Allowed: 0 to 1"""

class ArcLength(Table):
    steps: int
    """number of steps after which the path ends, unless the load reaches its end before. 0: the load must reach its end within 10 000 steps [steps]. Default: 0. Allowed: whole number from 0"""
    largest_step: float
    """largest step of the arc length. Steps grow up to it where the path is straight. The first step is 1/`loading.steps`; at first this is a step of the load factor. Default: 1e6. Allowed: 1e-12 to 1e6"""
    bifurcation: Literal["branch", "straight"]
    """what to do at a bifurcation of a stable path. `'branch'`: follow the other path; `'straight'`: continue on the same path, where states are unstable. Default: `'branch'`. Allowed: `'branch'`, `'straight'`"""

class Dynamics(Table):
    end_time: Quantity
    """time up to which the motion is followed, from 0 [s]. required. Allowed: positive"""
    scheme: Literal["verlet", "newmark"]
    """`'verlet'`: explicit steps; `'newmark'`: implicit steps, each of which finds an equilibrium with inertia by Newton's method, for motions that are slow compared with the stable step. Default: `'verlet'`. Allowed: `'verlet'`, `'newmark'`"""
    start: Literal["rest", "equilibrium"]
    """`'rest'`: undeformed, except for initial displacements; `'equilibrium'`: in equilibrium with supports and loads at t = 0, which Newton's method finds; it must not damage anything. Default: `'rest'`. Allowed: `'rest'`, `'equilibrium'`"""
    spectral_radius: float
    """implicit steps: factor by which a step multiplies the highest frequencies. 1: average acceleration, which conserves the energy; below 1: the generalised alpha method, which damps frequencies that the steps do not resolve. Default: 1. Allowed: 0 to 1"""
    time_step: Quantity
    """constant time step. Explicit: the run ends if it is longer than the stable step. Implicit: a step that does not converge is halved, down to a thousandth. The last step is shorter if necessary [s]. Default: a share of the stable step. Allowed: positive; explicit: at most the stable step"""
    step_share: float
    """time step as a share of the stable one, which is updated as the stiffness changes. Default: 0.9. Allowed: 1e-6 to 0.99"""
    history_every: int
    """number of steps from one row of the history to the next [time steps]. Default: `output.every`. Allowed: whole number from 1"""

class FatigueNucleation(Table):
    coefficient: float
    """A: a bond loses A (ε - limit)^m of its life in a cycle, ε the range of its stretch. required. Allowed: 1e-300 to 1e300"""
    exponent: float
    """m. required. Allowed: 0.1 to 100"""
    limit: float
    """range of the stretch up to which a bond does not age. Default: 0. Allowed: 0 to 1"""

class Fatigue(Table):
    load_ratio: float
    """R: supports and loads at the least load of a cycle over those at the largest, which is that at the end of `[loading]`. Default: 0. Allowed: -1 to 0.999"""
    cycles: float
    """number of cycles after which the run ends. 0: it ends when the body fails, or when no bond ages any more. Default: 0. Allowed: 0 to 1e18"""
    blocks: int
    """number of blocks of cycles after which the run ends; each block ends with the next bond that breaks. 0: no limit [blocks]. Default: 0. Allowed: whole number from 0"""
    life_tolerance: float
    """bonds with no more life left than this at the end of a block break in it, too. 0: only bonds with equal lives break together. Default: 0. Allowed: 0 to 0.5"""
    crack_damage: float
    """damage from which a point belongs to a crack. Bonds with an end within a horizon of such a point age by `growth`. Bonds that a `[[crack]]` has cut count. Default: 0.3. Allowed: 0.01 to 1"""
    nucleation: Inner[FatigueNucleation]
    """table: law of the bonds that no crack is near. Default: these bonds do not age"""
    growth: Inner[FatigueNucleation]
    """table: law of the bonds near a crack, whose life then begins anew. Default: all bonds age by `nucleation`"""

class Output(Table):
    directory: str
    """results folder, relative to the current folder; `--output` on the command line sets it, too. Default: `results/FOLDER_NAME` of the case file: `results/bar_tension` for `cases/bar/tension.toml`"""
    every: int
    """fields are written at every n-th accepted step (in mode `dynamics` every n-th time step), and at the last one [steps]. Default: 1; in mode `dynamics` about 100 time steps. Allowed: whole number from 1"""
    count_cracks: bool
    """whether `damage` and `max_damage` count the bonds that a `[[crack]]` has cut. If they do, pictures show the crack from the start. Default: false. Allowed: true, false"""
    stress: bool
    """whether strain and stress are among the fields: deformation gradient, strain, first Piola–Kirchhoff and Cauchy stress, von Mises' stress, principal values and directions (theory); they take several times the space of the other fields. Default: false. Allowed: true, false"""

class Probe(Table):
    name: str
    """name of the column. required. Allowed: letters, digits, `_`, `-`; at most 100 characters; no other probe has it"""
    set: str
    """set whose points give the value. exactly one of `set`, `at`, `from`. Allowed: name of a set or layer"""
    at: List
    """position; the nearest point gives the value [m]. exactly one of `set`, `at`, `from`. Allowed: a number per dimension"""
    from_: List
    """start of a line. The points within half a spacing of the line are written to `line_NAME.csv` [m]. exactly one of `set`, `at`, `from`. Allowed: a number per dimension"""
    field: Literal["displacement", "force", "damage", "energy_density", "stretch", "contact_force", "contact_pressure", "deformation_gradient", "divergence", "first_piola_stress", "strain", "stress", "von_mises", "principal_stress", "missing_neighbourhood", "velocity", "kinetic_energy_density", "life", "poisson_ratio", "opening", "crack_length", "crack_begin", "crack_end", "crack_angle", "crack_area", "work_of_fracture", "crack_resistance"]
    """field. Units: displacement, opening, length and position in m, area in m², force in N, energy densities in J/m³, velocity in m/s, stress in Pa, angles in degrees, work of fracture and crack resistance in J/m²; `stress` is the Cauchy stress, `strain` the Green–Lagrange strain. Default: `'displacement'`. Allowed: `'displacement'`, `'force'`, `'damage'`, `'energy_density'`, `'stretch'`, `'contact_force'`, `'contact_pressure'`, `'deformation_gradient'`, `'divergence'`, `'first_piola_stress'`, `'strain'`, `'stress'`, `'von_mises'`, `'principal_stress'`, `'missing_neighbourhood'`, `'velocity'`, `'kinetic_energy_density'`, `'life'`, `'poisson_ratio'`, `'opening'`, `'crack_length'`, `'crack_begin'`, `'crack_end'`, `'crack_angle'`, `'crack_area'`, `'work_of_fracture'`, `'crack_resistance'`"""
    to: List
    """end of the line [m]. required with `from`. Allowed: a number per dimension"""
    component: Literal["x", "y", "z", "1", "2", "3", "xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"]
    """component of a vector (`x`), of a tensor (`xy`; for a stress or a deformation gradient first the component, then the reference direction) or of `principal_stress` (`1`: the largest). all components of a vector; for other fields required with `set` and `at`. Allowed: `'x'`, `'y'`, `'z'`, `'1'`, `'2'`, `'3'`, `'xx'`, `'xy'`, `'xz'`, `'yx'`, `'yy'`, `'yz'`, `'zx'`, `'zy'`, `'zz'`"""
    statistic: Literal["mean", "max", "min", "rms_error", "max_error"]
    """statistic over the points of the set. `'mean'`: per component, with the same weight for all points; `'max'`: largest value per component; `'min'`: smallest value per component; `'rms_error'`: one number, the root mean square of the lengths of the differences from `expected`; `'max_error'`: the maximum of these lengths. Default: `'mean'`. Allowed: `'mean'`, `'max'`, `'min'`, `'rms_error'`, `'max_error'`"""
    expected: List
    """expected values of the components at a point's reference position. required with `rms_error` and `max_error`. Allowed: list of numbers or expressions of place and `load` (mode `dynamics`: `t`), one for each component of the field"""
    axis: Literal["x", "y", "z"]
    """`poisson_ratio`: direction of the pull; `crack_length`, `crack_begin`, `crack_end`: direction in which the crack runs; `crack_angle`: axis from which the angle is measured. Default: `'x'`. Allowed: `'x'`, `'y'`, `'z'`, as the dimension has them"""
    other: str
    """`opening`: the set on the other side of the crack. required with `opening`. Allowed: name of a set or layer"""

class CrackTip(Table):
    name: str
    """first part of the names of its columns. required. Allowed: letters, digits, `_`, `-`; at most 100 characters; no other crack tip has it"""
    at: List
    """position of the tip; 3D: any position on its straight front [m]. required. Allowed: a number per dimension"""
    direction: List
    """direction in which the crack would continue, a vector of any length. required. Allowed: a number per dimension; not all zero"""
    front: List
    """3D: direction of the front, a vector of any length. The front extends through the whole body. Default: `[0, 0, 1]`. Allowed: a number per dimension; at a right angle to `direction`"""
    inner: Quantity
    """inner radius of the ring of the integrals [m]. Default: 2 horizons, of points with their own the largest within the ring. Allowed: positive; at least 2 horizons"""
    outer: Quantity
    """outer radius of the ring [m]. Default: 4 horizons, or twice `inner`. Allowed: positive; at least a horizon more than `inner`"""
    cut: Quantity
    """length of a cut ahead of the tip, from which energy release rates follow. Every step then solves one more system of equations [m]. Default: none. Allowed: positive; at least a horizon"""

class Sensitivity(Table):
    over: List
    """numbers of the case, by their keys, with respect to which the columns of the history are differentiated (sensitivities). Default: none. Allowed: list of keys such as 'material.youngs_modulus'"""

class CaseTable(Table):
    title: str
    """one line that describes the case. Default: name of the file without its ending. Allowed: any text"""
    dimension: int
    """dimension of the body. required. Allowed: 1 to 3"""
    units: Inner[Units]
    """table: units of the plain numbers and expressions of the file. Default: SI units"""
    lattice: Inner[Lattice]
    """table: points on a lattice. exactly one of `lattice`, `points`"""
    points: Inner[Points]
    """table: points from a file. exactly one of `lattice`, `points`"""
    def add_set(self, *, name: str = ..., where: str = ..., shape: dict[str, Any] | Table = ...) -> Set: ...
    def add_crack(self, *, outline: List = ..., from_: List = ..., to: List = ..., vertices: List = ...) -> Crack: ...
    crack: Array[Crack]
    """tables: initial cracks. Default: none"""
    quadrature: Inner[Quadrature]
    """table: corrections of the weights. Default: all defaults"""
    material: Inner[Material]
    """table: model, constants and damage of the points that are in no region. required without `[[region]]`"""
    def add_region(self, *, set: str = ..., material: dict[str, Any] | Table = ...) -> Region: ...
    region: Array[Region]
    """tables: sets of points with materials of their own. Default: none"""
    def add_interface(self, *, between: List = ..., rule: Literal["harmonic", "arithmetic", "weaker"] = ..., material: dict[str, Any] | Table = ...) -> Interface: ...
    interface: Array[Interface]
    """tables: interactions between points of two materials. Default: none"""
    def add_support(self, *, set: str = ..., displacement: List = ...) -> Support: ...
    support: Array[Support]
    """tables: prescribed displacements. Default: none"""
    def add_rigid(self, *, set: str = ..., centre: List = ..., displacement: List = ..., rotation: List = ...) -> Rigid: ...
    rigid: Array[Rigid]
    """tables: sets that move as rigid bodies. Default: none"""
    def add_roller(self, *, set: str = ..., at: List = ..., to: List = ..., name: str = ..., normal: List = ..., displacement: Expression = ...) -> Roller: ...
    roller: Array[Roller]
    """tables: points that slide along a plane at any angle. Default: none"""
    def add_constraint(self, *, name: str = ..., displacement: Expression = ..., term: List = ...) -> Constraint: ...
    constraint: Array[Constraint]
    """tables: linear constraints between sets. Default: none"""
    def add_symmetry(self, *, axis: Literal["x", "y", "z"] = ..., at: Quantity = ...) -> Symmetry: ...
    symmetry: Array[Symmetry]
    """tables: planes of symmetry, with the bonds across them. Default: none"""
    def add_period(self, *, axis: Literal["x", "y", "z"] = ..., from_: Quantity = ..., to: Quantity = ..., gradient: List = ...) -> Period: ...
    period: Array[Period]
    """tables: sides across which the body repeats. Default: none"""
    def add_load(self, *, set: str = ..., body_force: List = ..., total_force: List = ..., gravity: List = ..., traction: List = ..., pressure: Expression = ..., stress: List = ..., boundary: str = ..., side: Literal["x-", "x+", "y-", "y+", "z-", "z+"] = ..., depth: Literal["row", "horizon", "surface"] = ...) -> Load: ...
    load: Array[Load]
    """tables: forces. Default: none"""
    def add_foundation(self, *, name: str = ..., set: str = ..., side: Literal["x-", "x+", "y-", "y+", "z-", "z+"] = ..., modulus: List = ..., stiffness: List = ..., displacement: List = ...) -> Foundation: ...
    foundation: Array[Foundation]
    """tables: springs between a part of the body and the ground. Default: none"""
    def add_contact(self, *, set: str = ..., with_: str = ..., shape: Literal["points", "faces"] = ..., distance: Quantity = ..., reach: Quantity = ..., stiffness: float = ..., depth: float = ..., softness: float = ..., friction: float = ..., tangential_stiffness: float = ...) -> Contact: ...
    contact: Array[Contact]
    """tables: contact of points that no whole bond joins. Default: none"""
    def add_obstacle(self, *, name: str = ..., set: str = ..., shape: Literal["plane", "cylinder", "sphere"] = ..., point: List = ..., normal: List = ..., axis: List = ..., radius: Quantity = ..., inside: bool = ..., displacement: List = ..., force: Expression = ..., stiffness: float = ..., depth: float = ..., softness: float = ..., friction: float = ..., tangential_stiffness: float = ...) -> Obstacle: ...
    obstacle: Array[Obstacle]
    """tables: rigid bodies that press on points. Default: none"""
    def add_eigenstrain(self, *, set: str = ..., strain: Expression = ...) -> Eigenstrain: ...
    eigenstrain: Array[Eigenstrain]
    """tables: strains without stored energy, such as growth or drying. Default: none"""
    temperature: Inner[Temperature]
    """table: change of temperature. Default: all defaults"""
    def add_control(self, *, set: str = ..., weights: List = ...) -> Control: ...
    control: Array[Control]
    """tables: the displacement that is prescribed instead of `load`. Default: none"""
    def add_initial(self, *, set: str = ..., displacement: List = ..., velocity: List = ...) -> Initial: ...
    initial: Array[Initial]
    """tables: displacements and velocities at time 0. Default: none"""
    def add_absorbing(self, *, set: str = ..., rate: Expression = ...) -> Absorbing: ...
    absorbing: Array[Absorbing]
    """tables: layers that absorb waves. Default: none"""
    loading: Inner[Loading]
    """table: the path of the loads, and its steps. Default: all defaults"""
    solver: Inner[Solver]
    """table: search for equilibrium. Default: all defaults"""
    relaxation: Inner[Relaxation]
    """table: steps by dynamic relaxation. Default: all defaults"""
    arc_length: Inner[ArcLength]
    """table: steps in mode `arc_length`. Default: all defaults"""
    dynamics: Inner[Dynamics]
    """table: the motion in time. required in mode `dynamics`"""
    fatigue: Inner[Fatigue]
    """table: cycles of the load. required in mode `fatigue`"""
    output: Inner[Output]
    """table: results folder. Default: all defaults"""
    def add_probe(self, *, name: str = ..., set: str = ..., at: List = ..., from_: List = ..., field: Literal["displacement", "force", "damage", "energy_density", "stretch", "contact_force", "contact_pressure", "deformation_gradient", "divergence", "first_piola_stress", "strain", "stress", "von_mises", "principal_stress", "missing_neighbourhood", "velocity", "kinetic_energy_density", "life", "poisson_ratio", "opening", "crack_length", "crack_begin", "crack_end", "crack_angle", "crack_area", "work_of_fracture", "crack_resistance"] = ..., to: List = ..., component: Literal["x", "y", "z", "1", "2", "3", "xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"] = ..., statistic: Literal["mean", "max", "min", "rms_error", "max_error"] = ..., expected: List = ..., axis: Literal["x", "y", "z"] = ..., other: str = ...) -> Probe: ...
    probe: Array[Probe]
    """tables: values that are recorded in the history. Default: none"""
    def add_crack_tip(self, *, name: str = ..., at: List = ..., direction: List = ..., front: List = ..., inner: Quantity = ..., outer: Quantity = ..., cut: Quantity = ...) -> CrackTip: ...
    crack_tip: Array[CrackTip]
    """tables: J, stress intensity factors and T-stress in the history. Default: none"""
    sensitivity: Inner[Sensitivity]
    """table: derivatives of the history with respect to numbers of the case. Default: all defaults"""
