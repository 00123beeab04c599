"""Draws the pictures of a results folder: ./peristat plot DIR -> DIR/plots/*.png, crack.gif

Exit codes: 0 if every possible picture is drawn (missing data is reported), 2 if DIR is no results folder, is
damaged, or its plots are a link or hold an unlisted picture, 5 if the pictures can't be written, 1 for a fault of
the program. Needs numpy, h5py and matplotlib, and no display.
"""

import argparse
import io
import os
import sys
import traceback
from pathlib import Path

from gallery import SCRIPT, Gallery, NoPlace
from results_folder import NotAResultsFolder, ResultsFolder, read_results_folder

DONE, BUG, WRONG_INPUT, MACHINE_FAILED, INTERRUPTED = 0, 1, 2, 5, 130
FORMATS = ("png", "pdf", "svg")
DOTS_PER_INCH = {"png": 100, "pdf": 200, "svg": 200}  # resolution of images within vector pictures
MOST_VECTORS = 3000  # number of shapes of one kind above which a vector picture stores them as an image
MOST_FRAMES = 6


def draw_all(results: ResultsFolder):
    """Yields name and figure of every picture that the results allow."""
    if results.step_numbers:
        yield from _draw_fields(results)
    from curve_pictures import draw_load_displacement, has_reactions

    if has_reactions(results):
        yield "load_displacement", draw_load_displacement(results)
    elif results.history:
        results.missing.append("no load_displacement: the history has no accepted step with reactions")
    from path_picture import draw_path, has_found_loads

    if has_found_loads(results):
        yield "path", draw_path(results)
    from event_path_picture import draw_events, has_events

    if has_events(results):
        yield "path", draw_events(results)
    from energy_picture import draw_energies, has_lost_energy

    if has_lost_energy(results):
        yield "energies", draw_energies(results)
    from crack_tip_picture import crack_tips, draw_crack_tips

    if crack_tips(results):
        yield "crack_tips", draw_crack_tips(results)
    from resistance_picture import draw_resistances, resistances

    if found := resistances(results):
        yield "resistance", draw_resistances(results, found)
    from tip_picture import draw_tips, running_tips

    if tips := running_tips(results):
        yield "tips", draw_tips(results, tips)
    from convergence_picture import draw_convergence, has_iterations

    if has_iterations(results):
        yield "convergence", draw_convergence(results)
    elif results.iterations:
        results.missing.append("no convergence: no search for equilibrium has two residuals")


def _draw_fields(results: ResultsFolder):
    import field_pictures

    step = results.step(results.step_numbers[-1])
    if results.dimension == 1:
        yield "deformed", field_pictures.draw_deformed_bar(results, step)
    elif results.dimension == 2:
        yield "deformed", field_pictures.draw_deformed_plane(results, step)
        yield "fields", field_pictures.draw_plane_fields(results, step)
        yield from _draw_fracture(results, step)
        if results.is_of_motion:
            import motion_pictures

            yield from motion_pictures.draw_motion(results, step)
    else:
        import solid_pictures

        yield "deformed", solid_pictures.draw_deformed_solid(results, step)
        yield "cut", solid_pictures.draw_cut_solid(results, step)
        import section_pictures

        if section_pictures.moves_visibly(results, step):
            yield "lateral", section_pictures.draw_lateral_solid(results, step)
            yield "middle_plane", section_pictures.draw_middle_plane(results, step)
        if step.damage.max() > 0.0:
            yield "damage", solid_pictures.draw_damaged_solid(results, step)
            yield from _draw_crack_surface(results, step)
    if results.dimension > 1:
        import stress_pictures

        yield from stress_pictures.draw_stresses(results, step)


def _draw_fracture(results: ResultsFolder, step):
    """Pictures of a plate with damage or broken bonds."""
    broken = results.broken_bonds()
    damaged = step.damage.max() > 0.0
    if not (damaged or len(broken.steps)):
        return
    import fracture_pictures

    if damaged:
        yield "damage", fracture_pictures.draw_damaged_plane(results, step)
    if len(broken.steps):
        yield "broken_bonds", fracture_pictures.draw_broken_bonds(results, broken)
    if damaged and len(results.step_numbers) > 1:
        frames = [results.step(number) for number in chosen_frames(results)]
        yield "sequence", fracture_pictures.draw_damage_sequence(results, frames)


def _draw_crack_surface(results: ResultsFolder, step):
    """Pictures of a solid in which a crack has grown."""
    from crack_surface import crack_surface

    surface = crack_surface(results, step)
    if not surface.has_grown:
        return
    import crack_surface_pictures

    yield "crack_surface", crack_surface_pictures.draw_crack_surface(results, step, surface)
    if len(results.step_numbers) > 1:
        frames = [results.step(number) for number in chosen_frames(results)]
        yield "sequence", crack_surface_pictures.draw_crack_surface_sequence(results, frames)


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
        from crack_animation import crack_animation
    except ImportError as error:
        results.missing.append(f"no crack.gif: it needs Python's PIL (Debian: python3-pil): {error}")
        return None
    return crack_animation(results)


def encoded(figure, ending: str) -> bytes:
    """A figure as a file; a vector picture holds large numbers of shapes as images, but texts and lines as vectors."""
    if ending != "png":
        for axes in figure.axes:
            for heap in axes.collections:
                heap.set_rasterized(len(heap.get_paths()) > MOST_VECTORS)
    file = io.BytesIO()
    options = {"pil_kwargs": {"compress_level": 4}} if ending == "png" else {}
    figure.savefig(file, format=ending, dpi=DOTS_PER_INCH[ending], **options)
    return file.getvalue()


def draw(directory: Path, ending: str) -> None:
    """Draws everything and prints what was drawn."""
    results = read_results_folder(directory)
    gallery = Gallery(directory)
    gallery.remove_earlier((f".{ending}", ".gif"))
    drawn = []
    for name, figure in draw_all(results):
        drawn.append(f"{name}.{ending}")
        gallery.add(drawn[-1], encoded(figure, ending))
    animation = animate(results)
    if animation:
        drawn.append("crack.gif")
        gallery.add(drawn[-1], animation)
    for sentence in results.missing:
        print(f"plot: {sentence}")
    print(f"plot: {gallery.path}: {', '.join(drawn) if drawn else 'nothing could be drawn'}")


def add_script(directory: Path) -> None:
    """Puts the script for ParaView into `plots`, and prints how to start it."""
    read_results_folder(directory)
    if not (directory / "results.xdmf").is_file():
        raise NotAResultsFolder(f"{directory}: no step has fields, so that there is no results.xdmf to show")
    text = (Path(__file__).parent / SCRIPT).read_text()
    known = text.replace("FOLDER = None", f"FOLDER = {str(directory.resolve())!r}", 1)
    gallery = Gallery(directory)
    gallery.add(SCRIPT, known.encode())
    print(f"plot: paraview --script={gallery.path / SCRIPT}")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="peristat plot", allow_abbrev=False,
        description="Draws the pictures of a results folder into DIR/plots (docs/results.md, Pictures); "
        "pictures of the same format that were drawn before are replaced.",
        epilog="Exit codes: 0 drawn (what is missing is said), 2 no results folder, or a damaged one, "
        "5 the pictures can't be written, 1 a bug.",
    )  # fmt: skip
    parser.add_argument("directory", metavar="DIR", type=Path, help="results folder of a run")
    parser.add_argument("--format", choices=FORMATS, default="png",
                        help="of the pictures (default: png; pdf and svg are vector graphics)")  # fmt: skip
    parser.add_argument("--paraview", action="store_true",
                        help=f"instead of pictures, write DIR/plots/{SCRIPT}, which shows damage and cracks in ParaView")  # fmt: skip
    return parser


def main(words: list[str]) -> int:
    try:
        arguments = _parser().parse_args(words)
    except SystemExit as ending:
        return DONE if ending.code in (0, None) else WRONG_INPUT
    try:
        if arguments.paraview:
            add_script(arguments.directory)
        else:
            draw(arguments.directory, arguments.format)
    except (NotAResultsFolder, NoPlace) as error:
        return _told(str(error), WRONG_INPUT)
    except OSError as error:
        return _told(f"{arguments.directory}: {error}", MACHINE_FAILED)
    except NameError:  # a fault of the program: no folder's content causes it
        traceback.print_exc()
        return _told(f"{arguments.directory}: a fault of the program, which is worth a report", BUG)
    except Exception as error:  # an unforeseen change in a folder that somebody has edited
        return _told(f"{arguments.directory}: can't be drawn ({type(error).__name__}: {error})", WRONG_INPUT)
    return DONE


def _told(sentence: str, code: int) -> int:
    line = "".join(c if c.isprintable() else " " for c in sentence)
    print(f"plot: {line if len(line) < 1000 else line[:1000] + '…'}", file=sys.stderr)
    return code


def guarded(words: list[str]) -> int:
    """Runs `main` in a process of its own, because the HDF5 library may crash on a damaged file."""
    child = os.fork()
    if child == 0:
        try:
            code = main(words)
            sys.stdout.flush()
        except KeyboardInterrupt:
            code = INTERRUPTED
        except OSError:  # nobody reads the output
            code = MACHINE_FAILED
        os._exit(code)
    try:
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    except KeyboardInterrupt:  # from the terminal; the child has received it, too
        return INTERRUPTED
    return code if code >= 0 else _told(f"reading {' '.join(words)} ended with signal {-code}: it is damaged", WRONG_INPUT)


if __name__ == "__main__":
    sys.exit(guarded(sys.argv[1:]))
