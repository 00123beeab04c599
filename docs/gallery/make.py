"""Runs the shipped cases one at a time and writes docs/gallery.md with their pictures and seconds.

    PERISTAT_PROGRAM=build/release/peristat nice /usr/bin/python3 -B docs/gallery/make.py --work FOLDER [CASE...]

The quick cases come first. A case whose keys have not changed since its run is skipped, so that the script goes on where
it was interrupted. `--seconds N` interrupts longer runs, whose picture then shows the state reached. `--redraw` draws the
pictures of kept results again, `--page` only writes the page. Seconds, points and steps are kept in runs.json.
"""

import argparse
import hashlib
import io
import json
import os
import pathlib
import re
import resource
import signal
import subprocess
import sys
import tomllib

from PIL import Image, ImageSequence

ROOT = pathlib.Path(__file__).resolve().parents[2]
CASES = ROOT / "cases"
PAGE = ROOT / "docs/gallery.md"
PICTURES = ROOT / "docs/pictures/gallery"
RUNS = pathlib.Path(__file__).with_name("runs.json")
FIRST = "start/crack", ROOT / "docs/pictures/first_crack.gif"
LARGEST = 38_000  # bytes of a picture
SECONDS = {"below a second": 0.5, "a second": 1, "seconds": 5, "a few seconds": 4, "some seconds": 6, "a minute": 60}

GROUPS = {
    "start": "Start",
    "plate_with_hole": "Plates with a hole",
    "four_holes": "Plate with four holes",
    "three_point_bending": "Notched beams",
    "compact_tension": "Compact tension",
    "fatigue": "Fatigue",
    "mesh": "Bodies of meshes",
    "bond_models": "Bonds in motion",
    "lps": "The linear solid",
    "fcbm": "Convolutions",
    "state": "The state-based solid",
    "cpd": "Large extensions by CPD",
    "regions": "Several materials",
    "periodic": "Periodic cells",
    "cantilever": "Cantilevers",
    "buckling": "Stability",
    "pressure": "Pressure",
    "contact": "Contact",
    "thermal": "Temperature",
    "bar": "One dimension",
}
SHOWS = {
    "start/crack": "A crack grows from a notch, turns to a hole that is cut exactly, and stops there. The first case to run.",
    "plate_with_hole/elastic": "The published plate with a hole, pulled apart without damage.",
    "plate_with_hole/ellipse": "Inglis's stress concentration at an elliptical hole, from a quarter of the plate.",
    "plate_with_hole/path": "The square plate of brittle bonds by sequentially linear analysis: one path, from one breaking bond to the next.",
    "plate_with_hole/quarter": "A quarter between two planes of symmetry, which matches the whole plate to round-off.",
    "plate_with_hole/rectangle": "The published plate that tears in two cracks, in mode `adaptive`.",
    "plate_with_hole/square": "Two cracks that run from the hole to the edges in one step; the case of the [tutorial](tutorial-fracture.md).",
    "four_holes/path": "A brittle crack that finds its way between four holes, from event to event.",
    "four_holes/tension": "A crack that finds its way between four holes, with a smaller horizon until damage begins.",
    "three_point_bending/half_disk": "A crack that turns and curves towards the load, through points without rows that are finer along its way.",
    "three_point_bending/mouth_opening": "A notched plate under control of its mouth opening, which follows the load down to two thirds of the peak.",
    "three_point_bending/notched": "The published notched plate, which softens over a long way under the moving load point.",
    "three_point_bending/path": "The notched plate of brittle bonds, from event to event: the displacement goes back again and again.",
    "three_point_bending/rollers": "A notched beam on ideal rollers, compared with ASTM E399.",
    "three_point_bending/toughness": "A glass beam that breaks at the toughness of its data sheet: where to begin with fracture of your own.",
    "compact_tension/pins": "A compact-tension specimen on two pins that rotate, compared with ASTM E399.",
    "fatigue/compact_tension": "A crack that grows in cycles of the load as Paris' law has it, up to the final failure of the specimen.",
    "mesh/crack_from_hole": "A crack from an elliptical hole on quadrilaterals of Gmsh, which know nothing of its way.",
    "mesh/elliptical_hole": "Stress at an elliptical hole on a mesh of Gmsh, compared with Inglis.",
    "bond_models/crack_branching": "A crack that branches in glass under sudden tension.",
    "bond_models/kalthoff_winkler": "An impact on a plate with two notches, whose cracks leave at an angle.",
    "bond_models/wave_propagation": "A wave from a ring of initial displacements.",
    "lps/crack_branching": "Glass whose crack branches under tractions on its edges.",
    "lps/disk": "A hollow disk under internal pressure, compared with Lamé.",
    "lps/fragmenting_ring": "A ring that a blast from inside breaks into pieces.",
    "lps/hole": "A circular hole in an infinite plate, compared with Kirsch.",
    "lps/inclusion": "A circular inclusion of another material, compared with its closed form.",
    "lps/manufactured": "A manufactured solution, for [rates of convergence](linear-solid.md).",
    "lps/patch": "The patch test, with tractions on all sides.",
    "lps/v_notch": "Glass that a wedge in its notch drives apart; the crack branches.",
    "fcbm/branching_2d": "Cracks in a notched glass plate whose points fail, without a stored bond.",
    "fcbm/glass_plate": "A crack that branches in 3D, by convolutions.",
    "fcbm/glass_plate_half": "The same twice as coarse, for less memory and time.",
    "fcbm/static_damage": "A notched strip under slow loading: equilibrium and failure alternate until no more points fail.",
    "fcbm/static_hole": "A plate with a hole in equilibrium, by convolutions and the preconditioner of sines.",
    "fcbm/waves": "A pulse that runs through a plate.",
    "state/glass_beam": "A notched beam of glass with its own Poisson's ratio, compared with ASTM E399.",
    "state/notched_bar": "A notched bar of steel that tears, in 3D at a ratio that bonds cannot have.",
    "state/plate_with_hole": "A steel plate with a hole, elastic; the same plate by `cpd` with one key changed.",
    "state/rubber": "A sheet with a hole, pulled to one and a half times its length: quadratic convergence in every increment.",
    "state/stretched_bar": "A bar pulled to one and a half times its length: the uniaxial law of the solid.",
    "cpd/cube": "A cube pulled to twice its length by Newton's method.",
    "cpd/cube_hole": "The same cube with a cubic hole.",
    "cpd/poisson_2d": "Poisson's ratio over the ratio of the constants, in 2D.",
    "cpd/poisson_3d": "Poisson's ratio over the ratio of the constants, in 3D.",
    "cpd/square": "A square pulled to twice its length.",
    "cpd/square_hole": "The same square with a square hole.",
    "cpd/table3": "The published table of residuals: Newton's method converges quadratically in every increment.",
    "regions/aggregates": "Concrete from an image: mortar, aggregates and pores from grey values.",
    "regions/bimaterial": "A bar of two materials, compared with its closed form.",
    "regions/composite": "A plate with fibres at an angle, compared with the lamina.",
    "periodic/holes": "The modulus of a sheet with holes, from one periodic cell.",
    "cantilever/beam": "A cantilever in 3D under its load.",
    "cantilever/plate": "A cantilever in plane stress.",
    "cantilever/vibration": "A cantilever that swings freely, by implicit steps, compared with Euler's frequency.",
    "buckling/arch": "A shallow arch that snaps through, by arc length.",
    "buckling/column": "A column that buckles, and its path beyond the bifurcation.",
    "pressure/ring": "A ring under a pressure that follows the deformation, compared with Lamé.",
    "contact/brazilian_disk": "A flattened disk between platens: the stresses at its centre.",
    "contact/closed_crack": "A cut bar that is pressed together: faces that close bear pressure, and nothing else.",
    "contact/four_point_bending": "A beam on four rollers: pure bending between the inner ones.",
    "contact/hertz": "A cylinder on a flat block, compared with Hertz.",
    "contact/impact": "Two halves of a bar that collide and part again, in explicit steps.",
    "contact/inclined_crack": "A closed crack at 45° under pressure: its faces slide with friction, and wings open at its tips.",
    "contact/impactor": "Kalthoff and Winkler's impact with the impactor as a body, which hits, stops and flies back.",
    "contact/incline": "A block on a slope: it sticks up to the angle of friction, and slides beyond.",
    "thermal/bimetal": "A heated strip of two metals that bends, compared with Timoshenko.",
    "bar/tension": "A bar in one dimension, compared with its closed form.",
}
# Cases that are not run for the page, and why.
WITHOUT = {"fcbm/glass_plate": "the case twice as coarse shows the same in less time and memory"}
# The first of these that a run draws is its picture, unless CHOSEN has another one.
PREFERRED = "sequence", "damage", "crack_surface", "fields", "deformed", "path", "column"
CHOSEN = dict.fromkeys(("buckling/arch", "buckling/column", "cantilever/plate", "cantilever/vibration", "cpd/poisson_2d", "cpd/square",
                        "cpd/square_hole", "state/rubber", "thermal/bimetal"), "deformed")  # fmt: skip


def names():
    """STUDY/NAME of all shipped cases in the order of the page."""
    found = [path.relative_to(CASES).with_suffix("").as_posix() for path in CASES.glob("*/*.toml")]
    order = list(GROUPS)
    return sorted(found, key=lambda name: (order.index(name.partition("/")[0]), name))


def header(name):
    """The comment at the top of a case, without its # signs."""
    lines = (CASES / f"{name}.toml").read_text("utf-8").splitlines()
    return [line.removeprefix("#").removeprefix(" ") for line in lines if line.startswith("#") and not line.startswith("#:")]


def subject(name):
    """The first line of the header, without the source at its end."""
    return re.split(r" {3,}", header(name)[0])[0].strip()


def keys_of(name):
    """Identifies what a case computes, whatever its comments say."""
    tables = tomllib.loads((CASES / f"{name}.toml").read_text("utf-8"))
    return hashlib.sha256(json.dumps(tables, sort_keys=True).encode()).hexdigest()[:12]


def length(name):
    """Seconds that the header promises, by which quick cases come first."""
    told = "\n".join(header(name)).partition("Time:")[2].strip()
    if number := re.search(r"(\d+) s\b", told):
        return float(number[1])
    return next((value for words, value in SECONDS.items() if told.startswith(words)), 600 if "minutes" in told else 40)


def runs():
    return json.loads(RUNS.read_text("utf-8")) if RUNS.exists() else {}


def picture_of(name):
    return PICTURES / f"{name.replace('/', '_')}.webp"


def run(name, work, most_seconds):
    """Runs a case and returns its entry of runs.json."""
    folder = work / name.replace("/", "_")
    words = [os.environ["PERISTAT_PROGRAM"], "run", CASES / f"{name}.toml", "--output", folder, "--overwrite",
             "--threads", "2", "--quiet"]  # fmt: skip
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    process = subprocess.Popen(words)
    try:
        code = process.wait(timeout=most_seconds)
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGINT)
        code = process.wait()
    if code not in (0, 130):
        sys.exit(f"{name}: exit code {code}")
    summary = json.loads((folder / "summary.json").read_text("utf-8"))
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    entry = {"keys": keys_of(name), "points": summary["points"], "steps": summary["steps"], "seconds": round(seconds, 1)}
    return entry | ({"interrupted": True} if code == 130 else {})


def draw(name, work):
    """Draws the pictures of a run and keeps the chosen one, small."""
    folder = work / name.replace("/", "_")
    command = ["/usr/bin/python3", "-BEs", ROOT / "python/peristat/pictures/__main__.py", folder]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    drawn = {path.stem: path for path in (folder / "plots").glob("*.png")}
    stem = CHOSEN.get(name) or next((stem for stem in PREFERRED if stem in drawn), None) or sorted(drawn)[0]
    picture_of(name).parent.mkdir(exist_ok=True)
    picture_of(name).write_bytes(small(Image.open(drawn[stem]).convert("RGB")))
    if name == FIRST[0]:
        animate(folder / "plots/crack.gif", FIRST[1])


def small(picture):
    """A WebP file of at most LARGEST bytes."""
    picture.thumbnail((800, 800), Image.Resampling.LANCZOS)
    for quality in range(80, 20, -5):
        written = io.BytesIO()
        picture.save(written, "WEBP", quality=quality, method=6)
        if written.tell() <= LARGEST:
            break
    return written.getvalue()


def animate(source, target):
    """A smaller copy of an animation."""
    with Image.open(source) as animation:
        frames = [frame.convert("RGB").resize((720, round(720 * frame.height / frame.width)), Image.Resampling.LANCZOS)
                  for frame in ImageSequence.Iterator(animation)]  # fmt: skip
        colours = frames[-1].quantize(64)  # the same in all frames, of which only changes are stored
        frames = [frame.quantize(palette=colours, dither=Image.Dither.NONE) for frame in frames]
        pauses = [250] * (len(frames) - 1) + [2000]
        frames[0].save(target, save_all=True, append_images=frames[1:], duration=pauses, loop=0, optimize=True)


def seconds_text(entry):
    if entry.get("interrupted"):
        return f"interrupted after {entry['seconds']:.0f} s of processor time: the picture shows the last of these steps"
    return f"{'below 1' if entry['seconds'] < 1 else format(entry['seconds'], '.0f')} s of processor time"


def section(name, entry):
    """The part of the page on one case."""
    told = header(name)
    time = " ".join("\n".join(told).partition("Time:")[2].split()).split(". ")[0].rstrip(".")
    lines = [f"### [{tomllib.loads((CASES / f'{name}.toml').read_text('utf-8'))['title']}](../cases/{name}.toml)", ""]
    if picture_of(name).exists():
        lines += [f"![{subject(name)}](pictures/gallery/{picture_of(name).name})", ""]
    lines += [f"{SHOWS[name]}", ""]
    lines += ["```sh", f"./peristat run cases/{name}.toml", "```", ""]
    if entry is None:
        return lines + [f"No picture: {WITHOUT.get(name, 'the run was not made')}. Time: {time}.", ""]
    return lines + [f"{entry['points']} points, {entry['steps']} steps, {seconds_text(entry)}.", ""]


def page():
    """The text of docs/gallery.md."""
    entries = runs()
    lines = ["# Gallery", "",
             "Each shipped case, with what it shows and how long it takes. The header of a case has its source, a sketch",
             "and the numbers to expect. Pictures are those that `run` draws, made smaller. Seconds are processor time of the",
             "run on two threads, which on two idle cores takes about half of it, without the pictures.",
             "`docs/gallery/make.py` writes this page.", ""]  # fmt: skip
    group = None
    for name in names():
        if name.partition("/")[0] != group:
            group = name.partition("/")[0]
            lines += [f"## {GROUPS[group]}", ""]
        lines += section(name, entries.get(name))
    return "\n".join(lines).rstrip("\n") + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("cases", nargs="*", metavar="CASE", help="STUDY/NAME; all by default")
    parser.add_argument("--work", type=pathlib.Path, help="folder of the results, which are kept")
    parser.add_argument("--seconds", type=float, default=300, help="after which a run is interrupted")
    parser.add_argument("--redraw", action="store_true")
    parser.add_argument("--page", action="store_true")
    options = parser.parse_args()
    for name in sorted(options.cases or set(names()) - set(WITHOUT), key=length):
        if options.page:
            break
        entries = runs()
        known = entries.get(name, {}).get("keys") == keys_of(name) and picture_of(name).exists()
        if not known:
            print(name, flush=True)
            entries[name] = run(name, options.work, options.seconds)
        if not known or options.redraw:
            draw(name, options.work)
        RUNS.write_text(json.dumps(dict(sorted(entries.items())), indent=1) + "\n", "utf-8")
    PAGE.write_text(page(), "utf-8")


if __name__ == "__main__":
    main()
