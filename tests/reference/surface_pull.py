"""Largest stress of bonds whose onsets follow a strength surface (docs/theory.md, Strength under any stress), under a
homogeneous stress of fixed form whose strain grows, in NumPy. The law is linear. No derivative is used: strain and
damage are found in turns.
"""

import math

import numpy

SQRT3 = math.sqrt(3)


def drucker_prager(principal, tension, compression):
    a, b, c = principal
    share = tension / compression
    j2 = ((a - b) ** 2 + (b - c) ** 2 + (c - a) ** 2) / 6
    return (SQRT3 * (1 + share) * math.sqrt(j2) + (1 - share) * (a + b + c)) / (2 * tension)


def mohr_coulomb(principal, tension, compression):
    return max(*principal, 0) / tension - min(*principal, 0) / compression


def rankine(principal, tension, _):
    return max(*principal, 0) / tension


class SurfacePull:
    def __init__(self, pull, youngs_modulus, poisson_ratio, onset, critical, utilisation, factor=(0.2, 100)):
        """pull: StatePull in 2D, plane stress; utilisation(principal stresses) is 1 where the first bond starts."""
        self.pull, self.utilisation = pull, utilisation
        self.onset, self.critical = onset, critical
        self.least, self.most = factor[0], min(factor[1], math.sqrt(critical / onset))
        self.modulus, self.ratio = youngs_modulus, poisson_ratio

    def rho(self, strain):
        tensor = numpy.array([[strain[0], strain[1] / math.sqrt(2)], [strain[1] / math.sqrt(2), strain[2]]])
        one, two = numpy.linalg.eigvalsh(tensor)
        plane = self.modulus / (1 - self.ratio**2)
        return self.utilisation((plane * (one + self.ratio * two), plane * (two + self.ratio * one), 0.0))

    def form(self, stresses, angle):
        axes = numpy.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
        tensor = axes.T @ numpy.diag(stresses) @ axes
        return tensor[self.pull.rows, self.pull.columns] * self.pull.factor

    def course(self, stresses, angle, step=2e-3):
        """Multiples of the stresses at the first onset and at the peak."""
        pull, form = self.pull, self.form(stresses, angle)
        whole = numpy.ones(len(pull.beta))
        unit = numpy.linalg.solve(pull.stiffness(whole), form)
        first = 1 / self.rho(unit)
        along = first * (unit @ form) * (1 - 1e-9)
        history, onset = numpy.zeros_like(whole), numpy.full_like(whole, self.onset)
        best = 0.0
        for _ in range(20000):
            for _ in range(10000):
                critical = self.onset * self.critical / onset
                with numpy.errstate(divide="ignore", invalid="ignore"):
                    soft = onset * (critical - history) / ((critical - onset) * history)
                integrity = numpy.where(history > onset, numpy.clip(soft, 0, 1), 1.0)
                strain = numpy.linalg.solve(pull.stiffness(integrity), form)
                stress = along / (strain @ form)
                driving = pull.driving(strain * stress, integrity, 0.0)
                rho = self.rho(strain * stress)
                new = driving[integrity > 0].max() / rho if rho > 0 else math.inf
                most = 1.0 if (history > 0).any() else self.most
                onset = numpy.where(history > 0, onset, numpy.clip(new, self.least * self.onset, most * self.onset))
                grown = numpy.where(driving > numpy.maximum(onset, history), driving, history)
                done = abs(grown - history).max() < 1e-9 * self.onset
                history = grown
                if done or stress < 0.5 * best:
                    break
            best = max(best, stress)
            if stress < 0.9 * best:
                return first, best
            along *= 1 + step
        raise AssertionError("no peak")
