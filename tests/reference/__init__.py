"""An independent reference: peridynamics by brute force, in NumPy.

Written from docs/theory.md and docs/case-file.md, shares nothing with the program, and prefers the
plain way to the fast one: all tuples of points are tried, forces stand beside energies whose
complex step has to give them, tangents are complex steps of forces.

    case      what a case file says, with its defaults
    laws      integrity and moment of the laws of damage
    saw_tooth laws that fall by drops, as mode path follows them
    sheets    moduli, fracture energy and strength as constants and stretches
    tear      what a plane tear takes from a lattice of cpd
    pull      what a lattice of bonds bears under a homogeneous stress
    body      points, interactions, weights
    mechanics energy, forces, tangent, damage
    results   what a results folder holds
    verify    whether the accepted steps of a run are what they claim
    events    whether a run of mode path goes from event to event
    program   runs peristat within limits
"""
