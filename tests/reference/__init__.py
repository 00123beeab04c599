"""An independent reference: peridynamics by brute force, in NumPy.

Written from docs/theory.md and docs/case-file.md, it shares no code with the program, and prefers simple
methods to fast ones: it tries all tuples of points, compares forces with complex steps of energies,
and takes tangents as complex steps of forces.

    case      a case file with its defaults
    laws      integrity and moment of the laws of damage
    saw_tooth laws that fall by drops, as mode path follows them
    sheets    moduli, fracture energy and strength as constants and stretches
    tear      energy of a plane tear in a lattice of cpd
    pull      strength of a lattice of bonds under a homogeneous stress
    body      points, interactions, weights
    mechanics energy, forces, tangent, damage
    results   contents of a results folder
    verify    checks the accepted steps of a run
    events    checks that a run of mode path goes from event to event
    program   runs peristat within limits
"""
