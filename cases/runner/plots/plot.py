"""Draws the pictures of a results folder: python3 plot.py DIRECTORY -> DIRECTORY/plots/*.png, crack.gif

Exit code 0 when everything that can be drawn is drawn (what is missing is said), 2 when DIRECTORY is no
results folder or its plots folder can't be written. Needs numpy, h5py and matplotlib; no display.
"""

import sys
from pathlib import Path

from results_folder import NotAResultsFolder, ResultsFolder, read_results_folder

PICTURES = [
    "deformed.png", "lateral.png", "middle_plane.png", "fields.png", "damage.png", "broken_bonds.png",
    "sequence.png", "load_displacement.png", "energies.png", "convergence.png", "crack.gif",
]  # fmt: skip
MOST_FRAMES = 6


def draw_all(results: ResultsFolder):
    """Name and figure of every picture that the results allow, one after the other."""
    if results.step_numbers:
        yield from _draw_fields(results)
    from curve_pictures import draw_convergence, draw_load_displacement, has_iterations, has_reactions

    if has_reactions(results):
        yield "load_displacement", draw_load_displacement(results)
    elif results.history:
        results.missing.append("no load_displacement.png: the history has no accepted step with reactions")
    from energy_picture import draw_energies, has_lost_energy

    if has_lost_energy(results):
        yield "energies", draw_energies(results)
    if has_iterations(results):
        yield "convergence", draw_convergence(results)
    elif results.iterations:
        results.missing.append("no convergence.png: no search for equilibrium has two residuals")


def _draw_fields(results: ResultsFolder):
    import field_pictures

    step = results.step(results.step_numbers[-1])
    if results.dimension == 1:
        yield "deformed", field_pictures.draw_deformed_bar(results, step)
    elif results.dimension == 2:
        yield "deformed", field_pictures.draw_deformed_plane(results, step)
        yield "fields", field_pictures.draw_plane_fields(results, step)
        yield from _draw_fracture(results, step)
    else:
        import solid_pictures

        yield "deformed", solid_pictures.draw_deformed_solid(results, step)
        import section_pictures

        if section_pictures.moves_visibly(results, step):
            yield "lateral", section_pictures.draw_lateral_solid(results, step)
            yield "middle_plane", section_pictures.draw_middle_plane(results, step)
        if step.damage.max() > 0.0:
            yield "damage", solid_pictures.draw_damaged_solid(results, step)


def _draw_fracture(results: ResultsFolder, step):
    """Pictures of a plate that has damage or broken bonds."""
    ends, steps = results.broken_bonds()
    damaged = step.damage.max() > 0.0
    if not (damaged or len(ends)):
        return
    import fracture_pictures

    if damaged:
        yield "damage", fracture_pictures.draw_damaged_plane(results, step)
    if len(ends):
        yield "broken_bonds", fracture_pictures.draw_broken_bonds(results, ends, steps)
    if damaged and len(results.step_numbers) > 1:
        frames = [results.step(number) for number in _frames(results)]
        yield "sequence", fracture_pictures.draw_damage_sequence(results, frames)


def animate(results: ResultsFolder, plots: Path) -> list[str]:
    """Writes the animation of a plate's damage where there is one; gives its name."""
    numbers = results.step_numbers
    if results.dimension != 2 or len(numbers) < 2 or not results.has_damage(numbers[-1]):
        return []
    try:
        from crack_animation import write_crack_animation
    except ImportError as error:
        results.missing.append(f"no crack.gif: it needs Python's PIL (Debian: python3-pil): {error}")
        return []
    write_crack_animation(results, plots / "crack.gif")
    return ["crack.gif"]


def _frames(results: ResultsFolder) -> list[int]:
    """Up to six steps, evenly spread from the first with damage to the last."""
    numbers = results.step_numbers
    first = next((i for i, number in enumerate(numbers) if results.has_damage(number)), 0)
    chosen = numbers[max(first - 1, 0) :]
    count = min(MOST_FRAMES, len(chosen))
    return [chosen[round(i * (len(chosen) - 1) / max(count - 1, 1))] for i in range(count)]


def main(arguments: list[str]) -> int:
    if len(arguments) != 1 or arguments[0].startswith("-"):
        print("usage: plot.py DIRECTORY", file=sys.stderr)
        return 0 if arguments in (["-h"], ["--help"]) else 2
    directory = Path(arguments[0])
    try:
        results = read_results_folder(directory)
        plots = directory / "plots"
        plots.mkdir(exist_ok=True)
        for name in PICTURES:
            (plots / name).unlink(missing_ok=True)
        drawn = []
        for name, figure in draw_all(results):
            figure.savefig(plots / f"{name}.png", pil_kwargs={"compress_level": 4})
            drawn.append(f"{name}.png")
        drawn += animate(results, plots)
    except NotAResultsFolder as error:
        print(f"plot: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"plot: {directory}: {error}", file=sys.stderr)
        return 2
    for sentence in results.missing:
        print(f"plot: {sentence}")
    print(f"plot: {plots}: {', '.join(drawn) if drawn else 'nothing could be drawn'}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
