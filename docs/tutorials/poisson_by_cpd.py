# %% [markdown]
# # Poisson's ratio by CPD
#
# Bonds alone have one constant, and with it a fixed Poisson's ratio: 1/3 in the plane, 1/4 in 3D.
# Continuum-kinematics- inspired peridynamics (CPD) adds interactions of triangles: a point and two of its neighbours
# resist changes of the area between them, with a constant C₂ beside C₁ of the bonds [CPD]. This tutorial pulls a
# strip for several C₂, measures ν from displacements, and compares it with what the lattice must have.

# %%
import matplotlib.pyplot as plt
import numpy as np

import peristat as ps

# %% [markdown]
# ## The strip
#
# The ends are pulled apart in x and may contract in y: clamped ends would change the ratio. By symmetry u_y = 0 on
# the axis, which keeps the strip in place. `origin = "nodes"` puts points on the axis. Constants are those of [CPD],
# so that stresses mean nothing here; ratios do.

# %%
case = ps.Case("strip", dimension=2, title="Strip under tension")
case.lattice = {"spacing": 0.02, "horizon_ratio": 3.015, "thickness": 1, "origin": "nodes"}
case.lattice.add_shape(add="box", min=[-0.5, -0.24], max=[0.5, 0.24])
case.lattice.add_layer(name="left", side="x-")
case.lattice.add_layer(name="right", side="x+")
case.add_set(name="axis", where="abs(y) < 0.1*spacing")
case.add_set(name="middle", where="abs(x) < 0.25 && abs(y) < 0.15")
case.material = {"model": "cpd", "c1": 1.0, "c2": 0.0}  # N/m6, N/m10
case.add_support(set="axis", displacement=["free", "0"])
for end in ("left", "right"):
    case.add_support(set=end, displacement=["1e-3*load*x", "free"])  # a strain of 0.1 %

# %% [markdown]
# ## Measure
#
# Away from the ends the strain is nearly homogeneous. Straight lines through the displacements of the middle, u_x
# over x and u_y over y, have it as slopes. (A probe with `field = "poisson_ratio"` does about the same.)


# %%
def measured(run):
    """Minus the lateral strain over the strain along the pull, in the middle of the strip."""
    middle = run.point_sets["middle"]
    x, u = run.positions[middle], run.displacement()[middle]
    along, across = (np.polyfit(x[:, axis], u[:, axis], 1)[0] for axis in (0, 1))
    return -across / along


constants = [-200, 0, 300, 600, 1200, 2400, 4800, 9600]  # N/m10, C2
sweep = ps.sweep(case, {"material.c2": constants}, quiet=True)
ratios = sweep.of(measured)
sweep[4].plot("deformed")

# %% [markdown]
# ## What the lattice must have
#
# `calibrate` sums all interactions of a point inside of the lattice, and gives its moduli. A lattice is slightly
# anisotropic: `axis_poisson_ratio` is that of a pull along its rows, as here; `poisson_ratio` is the mean over all
# directions. `continuum` has integrals instead of sums. There, with horizon δ and thickness h,
#
# $$\mu = \frac{\pi \delta^3 h}{24} C_1, \qquad
# \lambda = \mu + \frac{5 \pi^2 \delta^6 h^2}{9 (4\pi - 3\sqrt 3)} C_2, \qquad
# \nu = \frac{\lambda}{\lambda + 2\mu},$$
#
# since the model is purely two-dimensional, neither plane stress nor plane strain.

# %%
expected = []
for c2 in constants:
    case.material.c2 = c2
    expected.append(case.calibrate())  # dicts of moduli
axis = np.array([each["lattice"]["axis_poisson_ratio"] for each in expected])
mean = np.array([each["lattice"]["poisson_ratio"] for each in expected])
continuum = np.array([each["continuum"]["poisson_ratio"] for each in expected])

print("   C2   measured  along rows  all directions  continuum")
for row in zip(constants, ratios, axis, mean, continuum):
    print("{:5d} {:10.4f} {:11.4f} {:15.4f} {:10.4f}".format(*row))

figure, axes = plt.subplots(figsize=(9, 5))
axes.plot(constants, ratios, "o", label="measured on the strip")
axes.plot(constants, axis, label="lattice, pull along its rows")
axes.plot(constants, mean, "--", linewidth=1, label="lattice, all directions")
axes.plot(constants, continuum, ":", label="continuum")
axes.axhline(1 / 3, color="0.7", linewidth=0.8, label="bonds alone")
axes.set(xlabel="C₂ [N/m¹⁰], C₁ = 1 N/m⁶", ylabel="Poisson's ratio", title="Poisson's ratio of a strip in the plane")
axes.legend(loc="lower right")
plt.show()

# %% [markdown]
# What is measured is that of the lattice within 0.001, the effect of edges and ends. The ratio begins at 1/3 and
# tends to 1, where the area can't change any more. A negative C₂ lowers it; far below zero the body becomes unstable,
# and peristat refuses it. The continuum's curve lies lower for large C₂: at a horizon of three spacings the sum over
# triangles is 1.36 times their integral.
#
# **For a material of your own** don't give constants but what you know: `youngs_modulus` and `poisson_ratio`. C₁ and
# C₂ then follow on the lattice, so that the mean ratio is exact. The strip confirms it for ν = 0.4:

# %%
known = case.copy()
known.material = {"model": "cpd", "youngs_modulus": "2 GPa", "poisson_ratio": 0.4}
found = measured(known.solve(quiet=True))
lattice = known.calibrate()["lattice"]
print(f"mean {lattice['poisson_ratio']:.4f}, along the rows {lattice['axis_poisson_ratio']:.4f}, measured {found:.4f}")

# %%
delta, c = 3.015 * 0.02, np.array(constants)
shear = np.pi * delta**3 / 24
lame = shear + 5 * np.pi**2 * delta**6 / (9 * (4 * np.pi - 3 * np.sqrt(3))) * c
assert np.allclose(continuum, lame / (lame + 2 * shear), rtol=1e-9)  # the formula
assert all(run.converged for run in sweep) and np.abs(ratios - axis).max() < 0.0015
assert abs(mean[1] - 1 / 3) < 1e-9 and np.all(np.diff(ratios) > 0) and 0.85 < ratios[-1] < 1
assert abs(lattice["poisson_ratio"] - 0.4) < 1e-9 and abs(found - lattice["axis_poisson_ratio"]) < 0.0015
