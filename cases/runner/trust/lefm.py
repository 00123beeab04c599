"""Linear elastic fracture mechanics: closed forms that specimens are compared with."""

import math


def toughness(modulus: float, fracture_energy: float) -> float:
    """K_Ic = sqrt(E G_c) in plane stress [Pa sqrt(m)]."""
    return math.sqrt(modulus * fracture_energy)


def bend_factor(a: float) -> float:
    """f(a/W) of a single-edge notched beam with the span S = 4 W: K = P S f / (B W^1.5) (ASTM E399)."""
    return (3 * math.sqrt(a) * (1.99 - a * (1 - a) * (2.15 - 3.93 * a + 2.7 * a**2))
            / (2 * (1 + 2 * a) * (1 - a) ** 1.5))  # fmt: skip


def bend_load(toughness: float, width: float, crack: float, thickness: float) -> float:
    """P at which K of a notched beam is the toughness [N]."""
    return toughness * thickness * math.sqrt(width) / (4 * bend_factor(crack / width))


def bend_opening(a: float) -> float:
    """E B V / P of a notched beam with S = 4 W; V is the mouth opening, a stands for a / W: 24 a v(a)
    [Tada, Paris and Irwin 2000]."""
    return 24 * a * (0.76 - 2.28 * a + 3.87 * a**2 - 2.04 * a**3 + 0.66 / (1 - a) ** 2)


def tension_factor(a: float) -> float:
    """f(a/W) of a compact-tension specimen: K = P f / (B sqrt(W)) (ASTM E399)."""
    return (2 + a) * (0.886 + 4.64 * a - 13.32 * a**2 + 14.72 * a**3 - 5.6 * a**4) / (1 - a) ** 1.5


def tension_load(toughness: float, width: float, crack: float, thickness: float) -> float:
    return toughness * thickness * math.sqrt(width) / tension_factor(crack / width)


def tension_opening(a: float) -> float:
    """E B V / P of a compact-tension specimen; V is the mouth opening at the edge [Saxena and Hudak 1978]."""
    shape = 1.6137 + 12.678 * a - 14.231 * a**2 - 16.610 * a**3 + 35.050 * a**4 - 14.494 * a**5
    return (1 + 0.25 / a) * ((1 + a) / (1 - a)) ** 2 * shape


def panel_load(toughness: float, width: float, crack: float, thickness: float) -> float:
    """P of a panel of the given width with a central crack of half length `crack`: K = sigma sqrt(pi a sec(pi a / W)),
    within 0.3 % for 2 a / W below 0.8 [Tada, Paris and Irwin 2000, after Feddersen]."""
    stress = toughness / math.sqrt(math.pi * crack / math.cos(math.pi * crack / width))
    return stress * width * thickness


def double_edge_factor(a: float) -> float:
    """F of K = F sigma sqrt(pi a) of a panel under tension with a crack in both edges; a stands for its length over half
    of the width; within 0.5 % [Tada, Paris and Irwin 2000]."""
    return (1.122 - 0.561 * a - 0.205 * a**2 + 0.471 * a**3 - 0.190 * a**4) / math.sqrt(1 - a)


def edge_crack(toughness: float, stress: float) -> float:
    """Length of the edge crack of a half-plane that runs at this stress [m]."""
    return (toughness / (double_edge_factor(0.0) * stress)) ** 2 / math.pi


def cantilever_crack(modulus: float, fracture_energy: float, arm: float, opening: float) -> float:
    """Crack length of a double cantilever whose ends are `opening` apart [m]: 3 E h^3 D^2 / (16 (a + 0.64 h)^4) = G_c,
    where 0.64 of the arms' height accounts for the rotation at their root [Kanninen 1973]."""
    return (3 * modulus * arm**3 * opening**2 / (16 * fracture_energy)) ** 0.25 - 0.64 * arm


def cantilever_load(modulus: float, arm: float, thickness: float, crack: float, opening: float) -> float:
    """P at the ends of a double cantilever [N]."""
    return modulus * thickness * arm**3 * opening / (8 * (crack + 0.64 * arm) ** 3)


def williams_opening(toughness: float, modulus: float, poisson_ratio: float, x: str, y: str,
                     is_plane_strain: bool = False) -> tuple[str, str]:  # fmt: skip
    """Displacements of mode I around a tip at the origin in plane stress or strain, as expressions in x and y, which
    are given as texts: K / (2 mu) sqrt(r / 2 pi) (kappa - cos t) (cos t/2, sin t/2)."""
    size, kappa, t = _williams(toughness, modulus, poisson_ratio, x, y, is_plane_strain)
    size += f"*({kappa:.17g}-cos({t}))"
    return f"{size}*cos(0.5*{t})", f"{size}*sin(0.5*{t})"


def williams_sliding(toughness: float, modulus: float, poisson_ratio: float, x: str, y: str,
                     is_plane_strain: bool = False) -> tuple[str, str]:  # fmt: skip
    """Likewise of mode II: K / (2 mu) sqrt(r / 2 pi) ((kappa + 2 + cos t) sin t/2, (2 - kappa - cos t) cos t/2)."""
    size, kappa, t = _williams(toughness, modulus, poisson_ratio, x, y, is_plane_strain)
    return (f"{size}*({kappa + 2:.17g}+cos({t}))*sin(0.5*{t})",
            f"{size}*({2 - kappa:.17g}-cos({t}))*cos(0.5*{t})")  # fmt: skip


def _williams(toughness: float, modulus: float, poisson_ratio: float, x: str, y: str, is_plane_strain: bool) -> tuple[str, float, str]:
    """K / (2 mu) sqrt(r / 2 pi) as a text, kappa, and t as a text."""
    shear = modulus / (2 * (1 + poisson_ratio))
    kappa = 3 - 4 * poisson_ratio if is_plane_strain else (3 - poisson_ratio) / (1 + poisson_ratio)
    r, t = f"sqrt(({x})^2+({y})^2)", f"atan2({y},{x})"
    return f"{toughness / (2 * shear * math.sqrt(2 * math.pi)):.17g}*sqrt({r})", kappa, t


def hoop_direction(opening: float, sliding: float) -> float:
    """Angle [rad] at which the hoop stress near a tip with K_I, K_II is largest, where a crack turns if there is no
    T-stress: K_I sin t + K_II (3 cos t - 1) = 0 [Erdogan and Sih 1963]."""
    if sliding == 0.0:
        return 0.0
    ratio = opening / sliding
    return 2 * math.atan(0.25 * (ratio - math.copysign(math.sqrt(ratio**2 + 8), ratio)))
