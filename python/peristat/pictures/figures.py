"""The pictures that a results folder allows (docs/results.md, Pictures), in the order in which the program draws them."""

from collections.abc import Iterator
from functools import partial

from .drawing import Drawing
from .results_folder import ResultsFolder
from .style import Style, own_settings

MOST_FRAMES = 6
MOVIE = Style("movie", 10.5, 6.5, 13.0, 100, has_title=True)  # small: crack.gif is below a megabyte


def drawings(results: ResultsFolder, number: int | None = None) -> Iterator[Drawing]:
    """Every picture that the results allow; those of one step show step `number`, or else the last with fields."""
    if results.step_numbers:
        yield from _of_step(results, results.step_numbers[-1] if number is None else number)
    from .load_displacement_picture import draw_load_displacement
    from .reactions import has_reactions

    if has_reactions(results):
        yield Drawing("load_displacement", partial(draw_load_displacement, results))
    elif results.history:
        results.missing.append("no load_displacement: the history has no accepted step with reactions")
    from .path_picture import draw_path, has_found_loads

    if has_found_loads(results):
        yield Drawing("path", partial(draw_path, results))
    from .event_path_picture import draw_events, has_events

    if has_events(results):
        yield Drawing("path", partial(draw_events, results))
    from .energy_picture import draw_energies, has_lost_energy

    if has_lost_energy(results):
        yield Drawing("energies", partial(draw_energies, results))
    from .crack_tip_picture import crack_tips, draw_crack_tips

    if crack_tips(results):
        yield Drawing("crack_tips", partial(draw_crack_tips, results))
    from .resistance_picture import draw_resistances, resistances

    if found := resistances(results):
        yield Drawing("resistance", partial(draw_resistances, results, found))
    from .tip_picture import draw_tips, running_tips

    if tips := running_tips(results):
        yield Drawing("tips", partial(draw_tips, results, tips))
    from .convergence_picture import draw_convergence, has_iterations

    if has_iterations(results):
        yield Drawing("convergence", partial(draw_convergence, results))
    elif results.iterations:
        results.missing.append("no convergence: no search for equilibrium has two residuals")


def _of_step(results: ResultsFolder, number: int) -> Iterator[Drawing]:
    from .field_picture import draw_displacement

    step = results.step(number)
    yield Drawing("deformed", partial(draw_displacement, results, step), True)
    if results.dimension == 2:
        from .plane_fields_picture import draw_plane_fields

        yield Drawing("fields", partial(draw_plane_fields, results, step), True)
        yield from _of_fracture(results, step)
        if results.is_of_motion:
            from . import motion_pictures

            yield from motion_pictures.draw_motion(results, step)
    elif results.dimension == 3:
        from . import section_pictures, solid_pictures

        yield Drawing("cut", partial(solid_pictures.draw_cut_solid, results, step), True)
        if section_pictures.moves_visibly(results, step):
            yield Drawing("lateral", partial(section_pictures.draw_lateral_solid, results, step), True)
            yield Drawing("middle_plane", partial(section_pictures.draw_middle_plane, results, step), True)
        if step.damage.max() > 0.0:
            yield Drawing("damage", partial(solid_pictures.draw_damaged_solid, results, step), True)
            yield from _of_crack_surface(results, step)
    if results.dimension > 1:
        from . import stress_pictures

        yield from stress_pictures.draw_stresses(results, step)


def _of_fracture(results: ResultsFolder, step) -> Iterator[Drawing]:
    """Pictures of a plate with damage or broken bonds."""
    broken = results.broken_bonds()
    if step.number != results.step_numbers[-1]:
        broken = broken.until(step.number)
    damaged = step.damage.max() > 0.0
    if not (damaged or len(broken.steps)):
        return
    from . import fracture_pictures

    if damaged:
        yield Drawing("damage", partial(fracture_pictures.draw_damaged_plane, results, step), True)
    if len(broken.steps):
        yield Drawing("broken_bonds", partial(fracture_pictures.draw_broken_bonds, results, broken), True)
    if damaged and len(results.step_numbers) > 1:
        yield Drawing("sequence", lambda: fracture_pictures.draw_damage_sequence(results, _frames(results)))


def _of_crack_surface(results: ResultsFolder, step) -> Iterator[Drawing]:
    """Pictures of a solid in which a crack has grown."""
    from .crack_surface import crack_surface

    surface = crack_surface(results, step)
    if not surface.has_grown:
        return
    from . import crack_surface_pictures

    yield Drawing("crack_surface", partial(crack_surface_pictures.draw_crack_surface, results, step, surface), True)
    if len(results.step_numbers) > 1:
        yield Drawing("sequence", lambda: crack_surface_pictures.draw_crack_surface_sequence(results, _frames(results)))


def _frames(results: ResultsFolder) -> list:
    return [results.step(number) for number in chosen_frames(results)]


def chosen_frames(results: ResultsFolder) -> list[int]:
    """Up to six steps with about equal growth of damage in between: no panel is spent on steps in which nothing breaks.

    They include the first and the last step with damage, and the one before the largest burst.
    """
    numbers = [number for number in results.step_numbers if results.has_damage(number)]
    grown = [_damage_done(results, number) for number in numbers]
    if len(numbers) < 2 or None in grown or grown[-1] <= grown[0]:
        count = min(MOST_FRAMES, len(numbers))
        return [numbers[round(i * (len(numbers) - 1) / max(count - 1, 1))] for i in range(count)]
    burst = max(range(1, len(grown)), key=lambda place: grown[place] - grown[place - 1])
    chosen = {0, burst - 1, len(grown) - 1}
    for part in range(1, MOST_FRAMES):
        wanted = grown[0] + (grown[-1] - grown[0]) * part / (MOST_FRAMES - 1)
        reached = next(place for place, value in enumerate(grown) if value >= wanted or place == len(grown) - 1)
        if len(chosen) < MOST_FRAMES:
            chosen.add(reached)
    return [numbers[place] for place in sorted(chosen)]


def _damage_done(results: ResultsFolder, number: int) -> float | None:
    """A measure of damage at a step: broken bonds, or dissipated energy if no bond has broken."""
    bonds, energy = (results.in_history(number, name) for name in ("broken_bonds", "dissipated_energy"))
    return bonds if any(value for value in results.history.get("broken_bonds", []) if value) else energy


def animate(results: ResultsFolder) -> bytes | None:
    """The animation of a plate's damage, if there is any."""
    numbers = results.step_numbers
    if results.dimension != 2 or len(numbers) < 2 or not results.has_damage(numbers[-1]):
        return None
    try:
        from .crack_animation import crack_animation
    except ImportError as error:
        results.missing.append(f"no crack.gif: it needs Python's PIL (Debian: python3-pil): {error}")
        return None
    with own_settings(MOVIE):
        return crack_animation(results)
