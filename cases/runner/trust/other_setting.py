"""The setting with other material constants, another model, and with a groove; law, horizon, corrections and solver
stay."""

import setting


def of_material(text: str, modulus: float, fracture_energy: float, strength: float | None = None) -> str:
    """The case with another material: Pa, J/m2, Pa; without a given strength, the horizon determines it."""
    text = text.replace("no_fail = []\n", "")  # an empty list is refused
    text = _replaced(text, f"youngs_modulus = {setting.MODULUS}", f"youngs_modulus = {modulus}")
    damage = f"fracture_energy = {fracture_energy}" + (f"\nstrength = {strength}" if strength else "")
    return _replaced(text, f"fracture_energy = {setting.FRACTURE_ENERGY}", damage)


def of_ratio(text: str, poisson_ratio: float, plane: str) -> str:
    """The case with model `state`, of this Poisson's ratio, in plane stress or strain."""
    return _replaced(text, 'model = "bond"\nplane = "stress"\n', f'model = "state"\nplane = "{plane}"\npoisson_ratio = {poisson_ratio}\n')


def grooved(text: str, y: float) -> str:
    """Only bonds across the line at y can fail: two elastic regions, with the damage law only between them."""
    begin, damage, end = (text.index(head) for head in ("[material]\n", "[material.damage]\n", "[solver]\n"))
    material, law = text[begin:damage], text[damage:end]
    law = "".join(line for line in law.splitlines(True) if not line.startswith("no_fail"))
    below_it = lambda table: (material + (law if table == "interface" else "")).replace("[material", f"[{table}.material")
    regions = [f'[[set]]\nname = "{name}"\nwhere = "y {sign} {y}"\n\n[[region]]\nset = "{name}"\n\n{below_it("region")}'
               for name, sign in (("above", ">"), ("below", "<"))]  # fmt: skip
    interface = f'[[interface]]\nbetween = ["above", "below"]\n\n{below_it("interface")}'
    return text[:begin] + text[end:].rstrip() + "\n\n" + "".join(regions) + interface


def _replaced(text: str, old: str, new: str) -> str:
    if text.count(old) != 1:
        raise ValueError(f"{old!r} stands {text.count(old)} times in the setting")
    return text.replace(old, new)
