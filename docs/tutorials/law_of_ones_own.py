# %% [markdown]
# # A law of one's own
#
# How the force of a bond falls is a function of its stretch, and any function of NumPy will do. Concrete does not soften
# linearly: its stress falls steeply at first, and then has a long tail. Petersson's bilinear law says so. This tutorial
# gives it to the beam of [the notched beam](notched_beam.ipynb), and compares it with the linear law of the same energy.

# %%
import matplotlib.pyplot as plt
import numpy as np

import peristat as ps

onset, critical = 95.4e-6, 408.7e-6  # stretches of the linear law: 2.7 MPa and 89 J/m2 on a lattice of 40 mm
soft = critical - onset
bilinear_curve = ([onset, onset + 0.4 * soft, onset + 1.8 * soft], [onset, onset / 3, 0])


def linear(stretch):
    """Force of a bond over its stiffness; it equals the stretch where the bond is elastic."""
    return np.interp(stretch, [onset, critical], [onset, 0])


def bilinear(stretch):
    """Petersson's law: the kink is at a third of the force, and the area is that of the linear law."""
    return np.interp(stretch, *bilinear_curve)


laws = {
    "built-in, linear": {"law": "linear", "onset": onset, "critical": critical},
    "function, linear": ps.sampled_law(linear, elastic_until=onset, breaks_at=critical),
    "function, bilinear": ps.sampled_law(bilinear, elastic_until=onset, breaks_at=onset + 1.8 * soft),
}


# %%
def beam(law):
    """The beam of 800 mm under control of its notch's opening."""
    case = ps.Case("law", dimension=2, title="Notched beam of concrete")
    case.lattice = {"spacing": 0.04, "thickness": 0.1}
    case.lattice.add_shape(add="box", min=[-1.68, 0], max=[1.68, 0.8])
    case.add_crack(from_=[0, -0.8], to=[0, 0.24])
    case.quadrature = {"volume_correction": "linear", "surface_correction": "energy"}
    case.material = {"youngs_modulus": "25.85 GPa"}
    case.material.damage = law | {"no_fail": ["ends"]}
    case.add_set(name="ends", where="(abs(x) > 1.4 && y < 0.2) || (abs(x) < 0.2 && y > 0.68)")
    for name, x, y in (("left", -1.6, 0), ("right", 1.6, 0)):
        case.add_roller(name=name, at=[x, y], normal=[0, 1])
    case.add_roller(name="load", at=[0, 0.8], normal=[0, 1], displacement="-load")
    case.add_roller(name="middle", at=[0, 0.8], normal=[1, 0])
    for name, sign in (("right_lip", 1), ("left_lip", -1)):
        case.add_set(name=name, where=f"{sign}*x > 0 && {sign}*x < 0.06 && y < 0.06")
        case.add_control(set=name, weights=[sign, 0])
    case.loading = {"table": [0, 300e-6], "steps": 30, "stop_below": 0.9}
    return case


energies = {name: beam(law).calibrate()["damage"]["fracture_energy"]["mean"] for name, law in laws.items()}
runs = {name: beam(law).solve(quiet=True) for name, law in laws.items()}
forces = {name: np.abs(run.history["reaction_y:load"]) for name, run in runs.items()}

figure, (left, right) = plt.subplots(1, 2, figsize=(12, 4.5))
stretch = np.linspace(onset, 700e-6, 400)
for law in (linear, bilinear):
    left.plot(1e6 * np.r_[0, stretch], 1e6 * np.r_[0, law(stretch)], label=law.__name__)
left.set(xlabel="stretch [10⁻⁶]", ylabel="force / stiffness [10⁻⁶]", title="Laws of a bond")
for name, style in zip(laws, ("-", "--", "-")):
    right.plot(1e6 * runs[name].history["control"], forces[name] / 1e3, style, label=name)
    print(f"{name:20s} tear energy {energies[name]:.1f} J/m2, peak {forces[name].max() / 1e3:.2f} kN")
right.set(xlabel="opening of the notch [µm]", ylabel="force [kN]", title="Beam")
left.legend()
right.legend()
plt.show()

# %% [markdown]
# The function that repeats the built-in law has its peak: the curve is sampled, which costs nothing visible. The bilinear
# law has the same tear energy and a lower peak: at the peak bonds are only at the beginning of their softening.
#
# **For a law of your own** write the function of the stretch, from `elastic_until` to `breaks_at`.

# %%
built_in, same, steep = (forces[name].max() for name in laws)
assert all(run.converged for run in runs.values())
assert abs(same / built_in - 1) < 2e-3  # the same law, twice
assert np.ptp(list(energies.values())) < 0.01 * 89  # the same area under the laws
assert 0.75 < steep / built_in < 0.98  # a steeper beginning lowers the peak
