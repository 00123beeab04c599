"""Reads a mesh by meshio for the program, which starts this script and reads its standard output.

    read_mesh.py FILE

The answer is the line "mesh", and then nodes (count, count x 3 numbers), blocks of elements (type, nodes per element,
their nodes), groups (name, 1 for nodes or 0 for elements, members) and remarks; or the line "refused", and a sentence.
Counts and members are 64-bit integers, coordinates doubles, in the machine's order of bytes; texts follow their
length. Nodes and elements are counted from 0 in the order of the file, elements of all blocks together.
"""

import collections
import io
import os
import re
import resource
import sys
import warnings
from pathlib import Path

# Elements of Abaqus that meshio does not know: those of plane strain, and plane ones of second order.
MORE_OF_ABAQUS = {
    **{name + end: "triangle" for name in ("CPE3", "CPS3", "CAX3") for end in ("", "H", "T")},
    **{name + end: "quad" for name in ("CPE4", "CPS4", "CAX4") for end in ("", "H", "I", "IH", "R", "RH", "T", "RT")},
    **{name + end: "triangle6" for name in ("CPE6", "CPS6", "CAX6") for end in ("", "H", "M", "MH")},
    **{name + end: "quad8" for name in ("CPE8", "CPS8", "CAX8") for end in ("", "H", "R", "RH")},
    **{"C3D5": "pyramid", "C3D4H": "tetra", "C3D4T": "tetra", "C3D8T": "hexahedron", "C3D8RT": "hexahedron"},
}
MOST_VALUES = 100  # of a column of whole numbers that is taken for numbers of groups
FORMATS = {
    ".msh": "gmsh",
    ".inp": "abaqus",
    ".vtu": "vtu",
    ".vtk": "vtk",
    ".exo": "exodus",
    ".e": "exodus",
    ".ex2": "exodus",
    ".med": "med",
}


class Refusal(Exception):
    """Something in the file that can't be read, in words."""


def main(arguments) -> None:
    output = os.fdopen(os.dup(1), "wb")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # meshio prints
    sys.stdout, sys.stderr = io.StringIO(), io.StringIO()
    try:
        answer = b"mesh\n" + packed(*read(Path(arguments[0])))
    except Refusal as refusal:
        answer = b"refused\n" + str(refusal).encode()
    output.write(answer)
    output.close()


def loaded():
    try:
        import meshio
    except ImportError as error:
        raise Refusal(f"meshes are read by meshio, which is missing ({error}); install python3-meshio") from None
    return meshio


def read(file: Path):
    """Nodes, blocks, groups and remarks of a file."""
    meshio = loaded()
    if file.stat().st_size == 0:
        raise Refusal("the file is empty")
    seconds = 60 + 20 * file.stat().st_size // 10**6
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 5))  # a reader may not end on a broken file
    kind = FORMATS[file.suffix.lower()]
    before = {"abaqus": scanned_abaqus, "gmsh": scanned_gmsh}.get(kind, lambda _: None)(file)
    mesh = read_by_meshio(meshio, file, kind)
    remarks = [f"meshio: {line}" for line in printed() if line]
    if any("not closed by" in line for line in remarks):
        raise Refusal(f"the file ends early ({remarks[0]})")
    blocks = [block_of(block) for block in mesh.cells]
    groups = GROUPS[kind](mesh, file, before, remarks)
    return nodes_of(mesh), blocks, groups, remarks


def read_by_meshio(meshio, file: Path, kind: str):
    if kind == "abaqus":
        from meshio.abaqus import _abaqus

        for name, known in MORE_OF_ABAQUS.items():
            _abaqus.abaqus_to_meshio_type.setdefault(name, known)
        _abaqus.abaqus_to_meshio_type.update({"C3D4H": "tetra"})
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("error", message="string or file could not be read")
            warnings.filterwarnings("ignore", category=FutureWarning)
            return meshio.read(file, file_format=kind)
    except SystemExit:
        raise Refusal(f"meshio can't read it as {kind}{reason(' '.join(printed()))}") from None
    except ImportError as error:
        package = {"netCDF4": "python3-netcdf4", "h5py": "python3-h5py"}.get(error.name, error.name)
        raise Refusal(f"meshio needs {package} for this format, which is missing") from None
    except MemoryError:
        raise Refusal("the file asks for more memory than there is: it is broken, or very large") from None
    except Exception as error:  # meshio's readers fail in many ways on broken files
        told = " ".join(str(error).split())
        raise Refusal(f"meshio can't read it as {kind}: {type(error).__name__}{reason(told)}") from None


def reason(text: str) -> str:
    return f": {text[:300]}" if text.strip() else ", without a reason: it is broken, or of another kind"


def printed() -> list:
    """Lines that meshio has printed."""
    return [" ".join(line.split()) for text in (sys.stdout, sys.stderr) for line in text.getvalue().splitlines()]


# ---- nodes and elements --------------------------------------------------------------------------


def nodes_of(mesh):
    import numpy as np

    points = np.asarray(mesh.points, dtype=float)
    if points.ndim != 2 or not 1 <= points.shape[1] <= 3:
        raise Refusal("the file has no nodes")
    return np.pad(points, ((0, 0), (0, 3 - points.shape[1])))


def block_of(block):
    import numpy as np

    nodes = np.asarray(block.data)
    if nodes.dtype == object or nodes.ndim != 2:
        if len(nodes) == 0:
            return block.type, np.zeros((0, 1), dtype=np.int64)
        raise Refusal(f"elements of type {block.type} are not supported")
    return block.type, nodes.astype(np.int64)


def first_elements(mesh) -> list:
    """Number of the first element of each block, and the number of all."""
    first = [0]
    for block in mesh.cells:
        first.append(first[-1] + len(block.data))
    return first


# ---- groups --------------------------------------------------------------------------------------


def groups_of_sets(mesh) -> list:
    """The sets of elements and nodes that meshio returns."""
    import numpy as np

    first, groups = first_elements(mesh), []
    for name, of_blocks in mesh.cell_sets.items():
        if name.startswith("gmsh:"):
            continue
        try:
            members = [first[k] + np.asarray(of, dtype=np.int64) for k, of in enumerate(of_blocks) if of is not None]
            groups.append((name, 0, np.concatenate([np.zeros(0, dtype=np.int64), *members])))
        except (TypeError, ValueError):
            raise Refusal(f'the group "{name}" has a form that meshio does not read, such as a set of sets') from None
    for name, nodes in mesh.point_sets.items():
        groups.append((name, 1, np.asarray(nodes, dtype=np.int64).ravel()))
    return groups


def groups_by_number(mesh, column: str, names_of) -> list:
    """Groups of elements by a number that each has: names_of(number, dimension) lists their names."""
    import numpy as np

    first, members = first_elements(mesh), collections.defaultdict(list)
    for k, numbers in enumerate(mesh.cell_data.get(column, [])):
        for number in np.unique(numbers):
            for name in names_of(int(number), dimension_of(mesh.cells[k].type)):
                members[name].append(first[k] + np.flatnonzero(np.asarray(numbers) == number))
    return [(name, 0, np.concatenate(of)) for name, of in members.items()]


def dimension_of(kind: str) -> int:
    plain = kind.rstrip("0123456789")
    return {"vertex": 0, "line": 1, "triangle": 2, "quad": 2}.get(plain, 3)


def scanned_gmsh(file: Path) -> None:
    """Refuses what meshio would read without a word."""
    names = set()
    with open(file, "rb") as lines:
        for line in lines:
            if line.strip() == b"$EndPhysicalNames" or line.strip() in (b"$Nodes", b"$Elements"):
                return
            found = re.fullmatch(rb'\s*[0-3]\s+\d+\s+"(.*)"\s*', line)
            if found and found[1] in names:
                raise Refusal(f'has two physical groups called "{found[1].decode(errors="replace")}"; rename one')
            if found:
                names.add(found[1])


def gmsh_groups(mesh, file, before, remarks) -> list:
    names = {(int(data[0]), int(data[1])): name for name, data in mesh.field_data.items() if len(data) == 2}

    def names_of(number, dimension):
        if number == 0:
            return []
        if (number, dimension) not in names:
            what = ("Point", "Curve", "Surface", "Volume")[dimension]
            raise Refusal(
                f'physical group {number} of dimension {dimension} has no name; write Physical {what}("NAME", {number})'
            )
        return [names[number, dimension]]

    numbered = groups_by_number(mesh, "gmsh:physical", names_of)  # also refuses those without names
    sets = groups_of_sets(mesh)
    return sets + [group for group in numbered if group[0] not in {name for name, _, _ in sets}]


def scanned_abaqus(file: Path) -> list:
    """Name of the ELSET of each *ELEMENT, or None; refuses what meshio would read wrongly without a word."""
    of_elements, seen = [], set()
    with open(file, errors="replace") as lines:
        for line in lines:
            if not line.startswith("*") or line.startswith("**"):
                continue
            keyword, *parameters = [word.strip() for word in line.strip().upper().split(",")]
            values = dict(word.split("=", 1) for word in line.strip().split(",") if "=" in word)
            values = {key.strip().upper(): value.strip() for key, value in values.items()}
            if keyword in ("*INSTANCE", "*INCLUDE") and not (keyword == "*INSTANCE" and "*INSTANCE" not in seen):
                raise Refusal(f"{keyword} is not supported: write one flat file with one part")
            if keyword == "*NODE" and keyword in seen:
                raise Refusal("has two *NODE tables, of which meshio would read the last one alone; join them")
            if keyword == "*INSTANCE" and not next(lines).startswith("*"):
                raise Refusal("has an *INSTANCE that is moved; write one flat file with one part")
            name = values.get("ELSET" if keyword == "*ELSET" else "NSET")
            if keyword in ("*ELSET", "*NSET") and (keyword, name) in seen:
                raise Refusal(f'has two {keyword} tables called "{name}"; join them, or rename one')
            seen.update((keyword, (keyword, name)))
            if keyword == "*ELEMENT":
                of_elements.append(values.get("ELSET"))
    return of_elements


def abaqus_groups(mesh, file, of_elements, remarks) -> list:
    """Sets of *ELEMENT are taken from the keywords: meshio mixes up several of one name."""
    import numpy as np

    if len(of_elements) != len(mesh.cells):
        raise Refusal("its *ELEMENT tables can't be told apart")
    groups = [group for group in groups_of_sets(without(mesh, of_elements))]
    first = first_elements(mesh)
    for name in dict.fromkeys(name for name in of_elements if name):
        if name in mesh.cell_sets and name in {group[0] for group in groups}:
            raise Refusal(f'has two sets of elements called "{name}"; rename one')
        members = [np.arange(first[k], first[k + 1]) for k, of in enumerate(of_elements) if of == name]
        groups.append((name, 0, np.concatenate(members)))
    return groups


def without(mesh, names):
    mesh.cell_sets = {name: of for name, of in mesh.cell_sets.items() if name not in names}
    return mesh


def exodus_groups(mesh, file, before, remarks) -> list:
    """Blocks by their names or numbers, and sets of nodes."""
    import netCDF4
    import numpy as np

    def texts(name):
        if name not in of.variables:
            return []
        of.variables[name].set_auto_mask(False)
        return [b"".join(row).decode(errors="replace").strip("\0 ") for row in of.variables[name][:]]

    with netCDF4.Dataset(file) as of:
        numbers = of.variables["eb_prop1"][:] if "eb_prop1" in of.variables else range(1, len(mesh.cells) + 1)
        order = [int(key[7:]) - 1 for key in of.variables if re.fullmatch(r"connect\d+", key)]
        names = texts("eb_names")
        if "num_side_sets" in of.dimensions:
            remarks.append("side sets are not read by meshio; use sets of nodes, or [[set]]")
        node_names, node_numbers = texts("ns_names"), of.variables["ns_prop1"][:] if "ns_prop1" in of.variables else []
        node_sets = [
            (key, of.variables[key][:] - 1) for key in of.variables if re.fullmatch(r"node_ns\d+", key)
        ]
    first, groups = first_elements(mesh), []
    for k, block in enumerate(order):
        name = names[block] if block < len(names) and names[block] else f"block_{int(numbers[block])}"
        groups.append((name, 0, np.arange(first[k], first[k + 1])))
    for key, nodes in node_sets:
        k = int(key[7:]) - 1
        number = int(node_numbers[k]) if k < len(node_numbers) else k + 1
        name = node_names[k] if k < len(node_names) and node_names[k] else f"nodes_{number}"
        groups.append((name, 1, np.asarray(nodes, dtype=np.int64)))
    return groups


def med_groups(mesh, file, before, remarks) -> list:
    """Groups of the families of elements and nodes."""
    import numpy as np

    groups = groups_by_number(mesh, "cell_tags", lambda number, _: mesh.cell_tags.get(number, []))
    numbers, members = np.asarray(mesh.point_data.get("point_tags", [])), collections.defaultdict(list)
    for number in np.unique(numbers):
        for name in mesh.point_tags.get(int(number), []):
            members[name].append(np.flatnonzero(numbers == number))
    return groups + [(name, 1, np.concatenate(of)) for name, of in members.items()]


def vtk_groups(mesh, file, before, remarks) -> list:
    """Columns of whole numbers: a group NAME_VALUE for each value."""
    import numpy as np

    groups = []
    for column, of_blocks in mesh.cell_data.items():
        values = np.concatenate([np.asarray(of).ravel() for of in of_blocks]) if of_blocks else np.zeros(0)
        is_one = len(values) == sum(len(block.data) for block in mesh.cells)
        if not is_one or values.dtype.kind not in "iu" or len(np.unique(values)) > MOST_VALUES:
            continue
        name = re.sub(r"[^A-Za-z0-9_-]", "_", column)
        groups += groups_by_number(mesh, column, lambda value, _, name=name: [f"{name}_{value}"])
    return groups


GROUPS = {
    "gmsh": gmsh_groups,
    "abaqus": abaqus_groups,
    "exodus": exodus_groups,
    "med": med_groups,
    "vtk": vtk_groups,
    "vtu": vtk_groups,
}


# ---- answer --------------------------------------------------------------------------------------


def packed(nodes, blocks, groups, remarks) -> bytes:
    import numpy as np

    def integers(values) -> bytes:
        return np.ascontiguousarray(values, dtype=np.int64).tobytes()

    def text(words: str) -> bytes:
        return integers([len(words.encode())]) + words.encode()

    parts = [integers([len(nodes)]), np.ascontiguousarray(nodes, dtype=float).tobytes(), integers([len(blocks)])]
    for kind, elements in blocks:
        parts += [text(kind), integers(elements.shape), integers(elements)]
    parts.append(integers([len(groups)]))
    for name, of_nodes, members in groups:
        parts += [text(str(name)), integers([of_nodes, len(members)]), integers(members)]
    parts.append(integers([len(remarks)]))
    parts += [text(remark) for remark in remarks]
    return b"".join(parts)


if __name__ == "__main__":
    main(sys.argv[1:])
