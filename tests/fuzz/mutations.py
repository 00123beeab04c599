"""Mutations of case files, overrides, point files and results folders.

Every mutation takes the random generator first and leaves its inputs alone.
"""

import pathlib
import re

import h5py
import numpy

NUMBERS = """0 -0.0 1 -1 2 3 4 1e-3 0.5 1.0 1.5 1e300 -1e300 1e308 1.7976931348623157e308 1e309 1e-300 5e-324 1e-170
    2147483647 2147483648 4294967296 9223372036854775807 9223372036854775808 -9223372036854775808 1e18 1e12 1e6
    0x7fffffff 0b1 1_000 nan inf -inf +inf 07 1. .5 1e 0.1e+5000 1979-05-27T07:32:00Z 07:32:00""".split()
TEXTS = ['""', '"x"', '"load"', '"free"', '"left"', '"../../etc/passwd"', '"/dev/null"', '"/dev/zero"', '"."', '"none"', '"auto"',
         '"exact"', '"\\u0000"', '"\\U0001F4A5"', '"ünïcödé"', '"\\u202e abc"', '"a\\nb"', '"' + "A" * 100_000 + '"',
         "'''\nmany\nlines'''", '"%s%n%d"', '"$(touch x)"', '"nan"', '"inf"', '"2.5 mm"', '"3 MPa*sqrt(m)"', '"-1e400 m"', '"5 furlongs"', '"0.1 mm * load"', '"1/"', '"true"', "true", "false"]  # fmt: skip
EXPRESSIONS = ["1/0", "0/0", "load/0", "ln(-1)", "sqrt(-load)", "1e308*10*load", "x^x^x^x", "1e-3*load", "load*load*1e-4", "rint(load)",
               "load > 0.3 ? 1 : -1", "load > 0.6 ? 1/0 : 0", "(((((load", "load)", "x x", "x = 1", "y", "z", "q", "1,5", "sin()",
               "atan2(1)", "min()", "-" * 2000 + "1", "(" * 3000 + "1" + ")" * 3000, "+".join(["x"] * 3000), "1e-400", "load#", "load;x",
               "x = y = load", "_pi", "pi", "spacing", "1e-4*sin(300*load)", "0 < x < 1", "0.1 mm*load", "5 MPa*y/(2 mm)", "1 mm + 1 s", "(1 mm)^99", "x ? 1", "\"", "'", "\\", "load\u00b2", "∞", "1e-3*t", "sin(300*t)/t",
               "table('missing.csv', load)", "table('points.csv', load)", "table(load, load)", "table('/dev/zero', x)", "table('case.toml', 'x', t)", "table('"]  # fmt: skip
STRUCTURES = ["[]", "{}", "[[]]", "[1, 2]", "[1, 2, 3, 4]", "[1, \"a\"]", "[" * 500 + "]" * 500, "{a = {b = {c = 1}}}", "[" + "0," * 50_000 + "]",
              "{ disk = { centre = [0, 0], radius = -1 } }", "{ box = {} }", '["free", "free", "free"]', "[nan, inf]", "[[0, 0], [1, 1]]"]  # fmt: skip
WORDS = """dimension title lattice points ratio spacing horizon_ratio thickness area origin perturbation cell_perturbation lloyd_steps seed shape layer add subtract min max
    centre radius radii grey scale translate axis length vertices name side where file horizon set crack from to outline quadrature form volume_correction horizon_shape normals weights
    surface_correction material model plane influence youngs_modulus micromodulus poisson_ratio calibration c1 c2 c3 density damage law onset
    critical rate peak hardening fracture_energy fracture_toughness strength drive no_fail support displacement load body_force total_force loading steps adaptive smallest_step largest_step
    max_broken_bonds stop_below solver mode linear preconditioner tangent predictor projection relative_tolerance max_iterations fragments
    elastic_horizon_ratio relaxation iterations ramp breaking damping mass_factor quiet_iterations displacement_tolerance method flow_tolerance peak_tolerance output
    directory every count_cracks probe field other threshold control weights table table2 arc_length bifurcation region interface between
    rule fibre angle direction transverse_modulus shear_modulus transverse_critical scatter of factor distribution weibull_modulus
    correlation_length rigid roller at normal constraint term symmetry period gradient rotation gravity traction pressure depth eigenstrain
    strain temperature change thermal_expansion volumes neighbours at cut_bonds dynamics fatigue load_ratio cycles blocks life_tolerance crack_damage nucleation growth coefficient exponent limit end_time time_step step_share history_every initial velocity scheme
    spectral_radius absorbing degree traction_form boundary statistic expected
    kinematics operator stabilisation foundation obstacle inside softness point units force time mass stress energy length_unit""".split()
CHOICES = """rms_error max_error divergence blue_noise none linear exact exact_centroids volume energy mean bulk bond cpd lps collocation full paper surface stress strain lattice continuum critical_stretch tanh tanh_continuous linear exponential blended bilinear cornelissen table piecewise_constant cubic quintic septic gaussian inverse newton
    relaxation adaptive flow dynamic auto cholesky pcg minres gmres lu bicgstab local_operator jacobi block_jacobi rigid_pieces surrogate riluk chebyshev multigrid stored
    matrix_free consistent never always hold remove stop fixed moving at_equilibrium transient kinetic cell_centres nodes box disk ellipse image stl polygon
    cylinder sphere x- x+ y- y+ z- z+ displacement force damage stretch energy_density poisson_ratio opening crack_length crack_angle
    arc_length dynamics fatigue life verlet newmark branch straight cells fractional harmonic arithmetic weaker stiffness strength weibull row horizon x y z
    fft bonds finite release green_bond correspondence printed sines""".split()
KEYS = """dimension lattice.spacing lattice.horizon_ratio lattice.thickness lattice.area lattice.origin lattice.points lattice.lloyd_steps lattice.perturbation lattice.cell_perturbation lattice.seed
    lattice.shape[0].min lattice.shape[0].max lattice.shape[0].add lattice.shape[1].radius lattice.shape[9].add lattice.layer[0].thickness
    lattice.layer[0].where points.horizon points.horizon.ratio points.file set[0].where crack[0].from crack[0].to crack[0].outline quadrature.volume_correction
    quadrature.surface_correction quadrature.form quadrature.weights material.model material.plane material.influence material.youngs_modulus material.micromodulus
    material.poisson_ratio material.c1 material.c2 material.c3 material.damage material.damage.law material.damage.onset
    material.damage.critical material.damage.rate material.damage.no_fail support[0].displacement support[1].displacement support[0].set
    load[0].total_force load[0].body_force loading.steps loading.adaptive loading.smallest_step loading.largest_step
    loading.max_broken_bonds solver.mode solver.linear solver.preconditioner solver.tangent solver.predictor solver.projection
    solver.relative_tolerance solver.max_iterations solver.fragments solver.elastic_horizon_ratio relaxation.steps relaxation.load
    relaxation.iterations relaxation.ramp relaxation.breaking relaxation.damping relaxation.mass_factor relaxation.max_iterations
    control[0].weights control[0].set control[1].set loading.table loading.table2 arc_length.steps arc_length.largest_step
    arc_length.bifurcation lattice.angle lattice.volumes points.neighbours points.at points.cut_bonds material.fibre.angle material.fibre.transverse_modulus
    material.fibre.shear_modulus material.scatter[0].weibull_modulus material.scatter[0].factor material.scatter[0].correlation_length material.scatter[0].seed
    material.thermal_expansion material.density region[0].set region[0].material.youngs_modulus region[0].material.c1
    region[0].material.damage.critical interface[0].rule interface[0].between rigid[0].set rigid[0].centre rigid[0].displacement
    rigid[0].rotation roller[0].at roller[0].normal roller[0].displacement roller[1].normal constraint[0].displacement
    constraint[0].term[0].weights constraint[0].term[1].set symmetry[0].axis symmetry[0].at symmetry[1].at symmetry[1].axis period[0].from
    period[0].to period[0].gradient period[1].gradient period[1].axis load[0].gravity load[0].traction load[0].depth load[0].side
    load[0].pressure load[1].pressure load[1].total_force eigenstrain[0].strain eigenstrain[0].set temperature.change
    dynamics.end_time dynamics.time_step dynamics.step_share dynamics.history_every fatigue.cycles fatigue.blocks fatigue.load_ratio fatigue.life_tolerance
    fatigue.crack_damage fatigue.growth.coefficient fatigue.growth.exponent fatigue.nucleation.coefficient fatigue.nucleation.limit initial[0].set initial[0].displacement initial[0].velocity
    dynamics.scheme dynamics.spectral_radius absorbing[0].rate absorbing[0].set material.kinematics solver.operator material.stabilisation
    material.damage.fracture_energy material.damage.drive
    relaxation.quiet_iterations relaxation.displacement_tolerance relaxation.method relaxation.flow_tolerance relaxation.peak_tolerance output.every output.count_cracks probe[0].field probe[0].set probe[0]
    [[ ]. .. a.b.c lattice lattice. .lattice support[-1].set support[99999999999].set support[0]""".split()


def quoted(text):
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def value(random):
    """A value for a key: sensible, extreme, or nonsense."""
    kind = random.random()
    if kind < 0.35:
        return random.choice(NUMBERS)
    if kind < 0.5:
        return quoted(random.choice(CHOICES))
    if kind < 0.65:
        return quoted(random.choice(EXPRESSIONS))
    if kind < 0.75:
        return random.choice(STRUCTURES)
    if kind < 0.85:
        return random.choice(TEXTS)
    return f"{random.choice((-1, 1)) * 10 ** random.uniform(-20, 20):.6g}"


# ---- text ----------------------------------------------------------------------------------------


def replaced_value(random, lines):
    places = [k for k, line in enumerate(lines) if "=" in line]
    if places:
        k = random.choice(places)
        lines[k] = lines[k].split("=")[0] + "= " + value(random)


def scaled_number(random, lines):
    """Replaces a number by another one of its kind, which passes the checks most easily."""
    places = [(k, found) for k, line in enumerate(lines) for found in re.finditer(r"-?\d+\.?\d*(e-?\d+)?", line)]
    if places:
        k, found = random.choice(places)
        factor = random.choice((-1, 0, 0.1, 0.5, 0.9, 1.1, 2, 3, 10, 100, 1e6, 1e-6, 1e12, 1e-12, 1e100, 1e-100))
        number = float(found[0]) * factor
        text = str(int(number)) if found[0].lstrip("-").isdigit() and abs(number) < 1e9 else f"{number:.6g}"
        lines[k] = lines[k][: found.start()] + text + lines[k][found.end() :]


def misspelt_key(random, lines):
    places = [k for k, line in enumerate(lines) if "=" in line]
    if places:
        k = random.choice(places)
        lines[k] = random.choice([*WORDS, "", "ä", '"quoted key"', "a.b.c", "A" * 5000]) + " =" + lines[k].split("=", 1)[1]


def added_line(random, lines):
    word = random.choice(WORDS)
    line = random.choice((f"{word} = {value(random)}", f"[{word}]", f"[[{word}]]", f"[lattice.{word}]", f"[[lattice.{word}]]"))
    lines.insert(random.randint(0, len(lines)), line)


def moved_line(random, lines):
    lines.insert(random.randrange(len(lines)), lines.pop(random.randrange(len(lines))))


def dropped_line(random, lines):
    del lines[random.randrange(len(lines))]


def repeated_lines(random, lines):
    k = random.randrange(len(lines))
    part = lines[k : k + random.randint(1, 6)] * random.choice((1, 1, 2, 50))
    lines[k:k] = part


def mutated_text(random, text, others):
    """A case file corrupted in one to three places, as bytes."""
    lines = text.splitlines()
    for _ in range(random.choice((1, 1, 1, 2, 3))):
        kinds = (replaced_value, scaled_number, misspelt_key, added_line, moved_line, dropped_line, repeated_lines)
        random.choices(kinds, weights=(6, 8, 1, 2, 1, 1, 1))[0](random, lines)
        if not lines:
            lines = [""]
    if random.random() < 0.05:
        lines += random.choice(others).splitlines()
    data = ("\n".join(lines) + "\n").encode()
    return mutated_bytes(random, data) if random.random() < 0.1 else data


def mutated_bytes(random, data):
    data = bytearray(data)
    kind = random.randrange(6)
    at = random.randrange(len(data) + 1)
    if kind == 0:
        for _ in range(random.choice((1, 3, 30))):
            data[random.randrange(len(data))] = random.randrange(256)
    elif kind == 1:
        data[at:at] = random.choice((b"\0", b"\xff\xfe", b"\xef\xbb\xbf", b"\r", b"\x1b[2J", "é".encode("latin1"), b"\xed\xa0\x80"))
    elif kind == 2:
        del data[at:]
    elif kind == 3:
        data = data.replace(b"\n", b"\r\n")
    elif kind == 4:
        del data[at : at + random.randint(1, 40)]
    else:
        data[at:at] = data[max(0, at - 200) : at] * random.choice((1, 100))
    return bytes(data)


def mutated_neighbours(random, text):
    """A file of given neighbours corrupted in one to three places, as bytes."""
    lines = text.splitlines()
    for _ in range(random.choice((1, 1, 2, 3))):
        k = random.randrange(len(lines))
        kind = random.randrange(4)
        if kind == 0:
            cells = lines[k].split(",")
            cells[random.randrange(len(cells))] = random.choice([*NUMBERS, "i", "w_ij", "", "24", "25", "0.0", "A" * 10000])
            lines[k] = ",".join(cells)
        elif kind == 1:
            lines.insert(random.randrange(len(lines) + 1), lines[k])
        elif kind == 2:
            del lines[k : k + random.choice((1, 1, 5, 50))]
        else:
            lines[k] = lines[k].rpartition(",")[0] if random.random() < 0.7 else lines[k].replace(",", random.choice((" ", ";", "\t")))
        if not lines:
            lines = [""]
    data = ("\n".join(lines) + "\n").encode()
    return mutated_bytes(random, data) if random.random() < 0.15 else data


def mutated_points(random, text):
    """A file of points corrupted in one to three places, as bytes."""
    lines = text.splitlines()
    for _ in range(random.choice((1, 1, 2, 3))):
        k = random.randrange(len(lines))
        cells = lines[k].split(",")
        kind = random.randrange(6)
        if kind == 0:
            cells[random.randrange(len(cells))] = random.choice([*NUMBERS, *WORDS, "", "1e-30", "held|held", "|", '"1"', "1;2", "A" * 10000])
            lines[k] = ",".join(cells)
        elif kind == 1:
            lines.insert(random.randrange(len(lines) + 1), lines[k])
        elif kind == 2 and len(lines) > 1:
            del lines[k]
        elif kind == 3:
            lines[k] = ",".join([*cells, "1"] if random.random() < 0.5 else cells[:-1])
        elif kind == 4:
            column = random.randrange(3)
            for row in range(2, len(lines)):
                cells = lines[row].split(",")
                if column < len(cells) and re.fullmatch(r"\s*-?[\d.e+-]+\s*", cells[column]):
                    cells[column] = random.choice(("0", "1e-9", "1e9", cells[column]))
                    lines[row] = ",".join(cells)
        else:
            scale = 10 ** random.uniform(-12, 12)
            lines[2:] = [re.sub(r"-?\d+\.\d+", lambda found: f"{float(found[0]) * scale:.6g}", line) for line in lines[2:]]
    data = ("\n".join(lines) + "\n").encode()
    return mutated_bytes(random, data) if data and random.random() < 0.15 else data


# ---- results folders -----------------------------------------------------------------------------


def spoil_folder(random, folder):
    """Damages a results folder in place; returns a description."""
    folder = pathlib.Path(folder)
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    if not files:
        return "nothing left"
    path = random.choice(files)
    kind = random.choice(("bytes", "cut", "remove", "swap", "cells", "datasets", "datasets", "datasets", "links", "text"))
    if kind == "bytes":
        path.write_bytes(mutated_bytes(random, path.read_bytes()))
    elif kind == "cut":
        path.write_bytes(path.read_bytes()[: random.randrange(path.stat().st_size + 1)])
    elif kind == "remove":
        path.unlink()
    elif kind == "swap":
        path.write_bytes(random.choice(files).read_bytes())
    elif kind == "cells":
        path = random.choice(sorted(folder.glob("*.csv")))
        lines = path.read_text().splitlines()
        row = random.randrange(len(lines))
        cells = lines[row].split(",")
        cells[random.randrange(len(cells))] = random.choice([*NUMBERS, "", "text", "1,2", '"'])
        lines[row] = ",".join(cells)
        path.write_text("\n".join(lines) + "\n")
    elif kind == "text":
        path = folder / "summary.json"
        path.write_text(random.choice(("", "{}", "[]", "null", '{"status": 3}', "[" * 100_000, '{"status": "completed", "probes": 1}')))
    elif kind == "links":
        (folder / "plots").mkdir(exist_ok=True)
        name = random.choice(("results.h5", "history.csv", "plots/deformed.png", "summary.json"))
        (folder / name).unlink(missing_ok=True)
        (folder / name).symlink_to(random.choice((name.split("/")[-1], "/dev/null", "/nonexistent", ".", "/dev/full")))
    else:
        path = folder / "results.h5"
        spoil_datasets(random, path)
    return f"{kind} of {path.name}"


def spoil_datasets(random, path):
    with h5py.File(path, "r+") as file:
        names = []
        file.visit(names.append)
        for _ in range(random.choice((1, 1, 2, 5))):
            name = random.choice(names)
            if name not in file:
                continue
            item, kind = file[name], random.randrange(7)
            if kind == 0 or not isinstance(item, h5py.Dataset):
                del file[name]
                if kind == 1:
                    file[name] = h5py.SoftLink(random.choice(("/", f"/{name}", "/nowhere")))
                elif kind == 2:
                    file[name] = h5py.ExternalLink(random.choice((path.name, "/dev/zero", "gone.h5")), "/points")
                continue
            old = item[...]
            del file[name]
            if kind == 1:
                file.create_dataset(name, data=numpy.full(old.shape or (1,), random.choice((numpy.nan, numpy.inf, -1e308, 0, 1e300))))
            elif kind == 2:
                file.create_dataset(name, data=old.ravel()[: random.randint(0, 3)] if old.shape else old)
            elif kind == 3:
                file.create_dataset(name, shape=(10**random.randint(6, 12), 3), dtype="f8", chunks=(1000, 3))
            elif kind == 4:
                file.create_dataset(name, data=numpy.array([b"text"] * max(1, min(len(old) if old.shape else 1, 50))))
            elif kind == 5:
                file.create_dataset(name, data=numpy.zeros((2, 3, 4)))
            else:
                file.create_group(name)
