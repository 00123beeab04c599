# %% [markdown]
# # A crack steered from Python
#
# Two bars of glass are glued together and pulled apart at their ends: the double cantilever beam by which
# glues are tested. The opening of the ends is prescribed. A crack runs through the glue, at first fast and then
# ever more slowly, because a longer crack needs a larger opening.
#
# Here a program turns the opening **while the run goes on**: after each step it looks at the energy that has
# been dissipated and chooses the next opening, so that the crack grows by half a millimetre per step. This is
# how a testing machine would be steered by a crack gauge.

# %%
import matplotlib.pyplot as plt
import numpy as np
import peristat as ps

# %% [markdown]
# ## The body
#
# The plate is 1 mm thick, in plane stress. Each bar is a region of its own without damage. Bonds between the
# two regions are the glue: they have the modulus of glass and soften linearly from a stretch of 3e-5 until
# they are broken, such that a crack takes `toughness` per area. The first 20 mm are not glued.
# A pin near the end of each bar moves as a rigid disk and rotates freely.

# %%
length, height, precrack, pin = 80e-3, 8e-3, 20e-3, 3e-3  # m; height of one bar, place of the pins
thickness, modulus, toughness = 1e-3, 70e9, 10.0  # m, Pa, J/m2


def glued_bars(opening_of_half):
    """The specimen; `opening_of_half` is the displacement of the upper pin [m]."""
    case = ps.Case("glued_bars", dimension=2, title="Two glued bars")
    case.lattice.update(spacing="1 mm", thickness=thickness)
    case.lattice.add_shape(add="box", min=[0, -height], max=[length, height])
    case.quadrature.update(volume_correction="linear", surface_correction="energy")
    case.add_crack(from_=[-1e-3, 0], to=[precrack, 0])
    case.add_set(name="upper", where="y > 0")
    case.add_set(name="lower", where="y < 0")
    for name in ("upper", "lower"):
        case.add_region(set=name, material={"youngs_modulus": modulus})
    softening = {"law": "linear", "fracture_energy": toughness, "onset": 3e-5}
    case.add_interface(between=["upper", "lower"], material={"youngs_modulus": modulus, "damage": softening})
    for name, sign in (("upper", 1), ("lower", -1)):
        centre = [pin, sign * height / 2]
        case.add_set(name=f"{name}_pin", shape={"disk": {"centre": centre, "radius": 1.6e-3}})
        case.add_rigid(
            set=f"{name}_pin",
            centre=centre,
            displacement=["0", lambda load, sign=sign: sign * opening_of_half(load)],
        )
    case.loading.steps = 100  # at most; the loops below leave earlier
    return case


def crack_length(step):
    """Length of a crack of this dissipated energy [m]."""
    return precrack + step.dissipated_energy / (toughness * thickness)


# %% [markdown]
# `crack_length` measures the crack by the energy that it has taken. It grows smoothly, while the number of
# broken bonds jumps from one row of points to the next.
#
# ## Without a controller
#
# The opening grows by equal amounts. The crack's speed is what it wants to be.

# %%
end = precrack + 30e-3  # m; where the tests end


def record(step, half):
    return [2 * half(step.load), step.reactions["upper_pin"][1], crack_length(step)]


def ramp(load):
    return 1.2e-4 * load


steps = glued_bars(ramp).body().steps(quiet=True)
rows = []
for step in steps:
    rows.append(record(step, ramp))
    if crack_length(step) > end:
        break
free = np.array(rows)

# %% [markdown]
# ## With a controller
#
# A `Dial` stands where an expression of the load may stand. `turn_to(value, step, within=...)` says where it goes
# from the present step on, while the load factor grows by `within`: here by one step. Step 0 is the body at rest.
#
# The plan is a crack that is half a millimetre longer after each step. The controller knows nothing of
# beams. It supposes that the crack answers the next increment of the opening as it answered the last four in the
# mean, and also makes up for half of what the crack is behind or ahead of the plan. Four steps are two spacings:
# between two rows of points the crack's answer goes up and down.

# %%
speed = 0.5e-3  # m of crack per step
one = 1 / 100  # load factor of a step
half = ps.Dial(0.0)
increment = 0.8e-6  # m, while the body is still elastic

rows, plan = [], []
steps = glued_bars(half).body().steps(quiet=True)
for step in steps:
    rows.append(record(step, half))
    opened, _, grown = np.subtract(rows[-1], rows[max(-5, -len(rows))])
    length_now = crack_length(step)
    if plan:
        plan.append(plan[-1] + speed)
    elif grown > 4 * speed:
        plan.append(length_now)  # from here on the crack is steered
    if plan:
        wanted = speed + (plan[-1] - length_now) / 2
        increment = np.clip(wanted * opened / 2 / grown, increment / 2, increment * 2)
    half.turn_to(half(step.load) + increment, step, within=one)
    if length_now > end:
        break
steered = np.array(rows)
run = steps.run
print(run.status, "after", len(rows) - 1, "steps")

# %% [markdown]
# `steps.run` is the `Run` with all results of the folder, as `solve` returns it. The loop was left early, so its
# status is "interrupted".
#
# ## Did it keep its promise?

# %%
plan = np.array(plan)
lag = steered[-len(plan) :, 2] - plan
growth = np.diff(steered[-len(plan) :, 2])
print(f"largest distance from the plan {abs(lag).max() * 1e3:.3f} mm in {plan[-1] - plan[0]:.3f} m")
print(f"growth per step {growth.min() * 1e3:.3f} to {growth.max() * 1e3:.3f} mm, wanted {speed * 1e3} mm")
free_growth = np.diff(free[:, 2])
print(f"without control up to {free_growth.max() * 1e3:.2f} mm per step, {free_growth[-1] * 1e3:.2f} mm at the end")

figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.6), layout="constrained")
left.plot(free[:, 2] * 1e3, ".-", label="equal increments of the opening")
left.plot(steered[:, 2] * 1e3, ".-", label="steered")
left.set(xlabel="step", ylabel="crack length [mm]")
left.legend()
right.plot(np.diff(steered[:, 0]) * 1e6, ".-", color="C1")
right.set(xlabel="step", ylabel="increment of the opening [µm]");

# %% [markdown]
# ## Load and opening
#
# Beam theory for a crack that grows at constant toughness $G$: with the inertia $I = t h^3/12$ of a bar, arms of the
# length $a$ open by $\delta = 2 P a^3/(3 E I)$, and $G = P^2 a^2/(E I t)$. Without $a$ this is
#
# $$P^2 \delta = \tfrac{2}{3}\,(G\,t)^{3/2} \sqrt{E I}.$$
#
# A clamping that yields, an arm that is effectively longer, cancels as well.

# %%
inertia = thickness * height**3 / 12
constant = 2 / 3 * (toughness * thickness) ** 1.5 * np.sqrt(modulus * inertia)
opening = np.linspace(20e-6, steered[-1, 0], 200)

figure, axes = plt.subplots(figsize=(6, 3.6), layout="constrained")
axes.plot(free[:, 0] * 1e6, free[:, 1], label="equal increments")
axes.plot(steered[:, 0] * 1e6, steered[:, 1], ".", label="steered")
axes.plot(opening * 1e6, np.sqrt(constant / opening), "k--", label="beam theory")
axes.set(xlabel="opening [µm]", ylabel="force [N]", ylim=(0, None))
axes.legend();

# %%
run.plot("damage")

# %% [markdown]
# ## How good is it?

# %%
running = steered[-len(plan) :]
measured = (1.5 * running[:, 1] ** 2 * running[:, 0] / np.sqrt(modulus * inertia)) ** (2 / 3) / thickness
print(f"toughness by beam theory {measured.min():.2f} to {measured.max():.2f} J/m2, given {toughness} J/m2")
print(f"largest force {free[:, 1].max():.2f} and {steered[:, 1].max():.2f} N")

# %% [markdown]
# The crack keeps within 0.1 mm of its plan, a tenth of the spacing, and each step's growth within 15 % of the wanted
# one. The toughness that the test would give by beam theory is 6 to 8 % too small and changes by
# 2.5 % while the crack becomes twice as long: the simple formula leaves out shear and the bars' being
# only eight points high.
#
# **For your own problem.** What the controller looks at is yours: `step.probes`, `step.reactions`,
# `step.broken_bonds`, `step.max_damage` or any `step.field(...)`. What it turns may be any displacement or load that
# may be an expression of `load`. If a single sum of displacements is to grow steadily, such as a crack mouth
# opening, you need no program: `[[control]]` of a case makes it an unknown of each state and also follows
# openings that must decrease. A softer onset (`onset`) or a finer spacing makes the growth smoother.

# %%
assert abs(lag).max() < 0.1e-3
assert 0.85 * speed < growth.min() and growth.max() < 1.15 * speed
assert free_growth.max() > 1.6 * speed  # there was something to steer
assert abs(measured / toughness - 1).max() < 0.1
assert np.ptp(measured) < 0.04 * toughness
