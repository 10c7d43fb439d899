"""Physics that isopeel does not have: what there is instead, for a key or a kind that a case names."""

_RATE = "isopeel has no rate effects; give a work_of_adhesion that was measured at the rate of the test"
_TIME = "isopeel computes equilibria, without time; drive.to and drive.step are in the parameter of the drive"
_HEAT = "isopeel has no temperature; give constants that were measured at the temperature of the test"
_FRICTION = "isopeel has no friction; sliding_length makes a joint hold along the substrate"
_VISCOUS = "isopeel has no viscosity; give the elastic constants at the rate of the test"
_INERTIA = "isopeel has no inertia and no gravity; a [[load]] is a dead force on a boundary"
_PLASTIC = "isopeel has no plasticity; materials are hyperelastic"
_ISOTROPIC = (
    "isopeel has no orthotropic materials; each body is isotropic, and layers are bodies with a [[tie]]"
)
_PLANE = "isopeel computes plane strain; body.width is the extent across the plane, which only scales forces"
_SPHERE = "isopeel has no three dimensions; 'half-cylinder' is the body of this kind in the plane"
_PRESSURE = "isopeel has no pressure on a boundary; a [[load]] is a dead force per width"
_THICKNESS = "the thickness of a strip is its height, and its extent across the plane is its width"
_CYCLES = "isopeel has no fatigue; several [[drive]] tables load and unload"

#: What is said of keys of these names, where a table has no such key.
KEYS = (
    dict.fromkeys(
        ("rate", "peel_rate", "strain_rate", "loading_rate", "speed", "velocity", "peel_speed"), _RATE
    )
    | dict.fromkeys(("time", "duration", "time_step", "end_time", "dt"), _TIME)
    | dict.fromkeys(("temperature", "thermal_expansion", "heat"), _HEAT)
    | dict.fromkeys(("friction", "friction_coefficient", "coulomb", "mu"), _FRICTION)
    | dict.fromkeys(
        ("viscosity", "relaxation_time", "relaxation", "damping", "prony", "loss_modulus"), _VISCOUS
    )
    | dict.fromkeys(("density", "gravity", "inertia"), _INERTIA)
    | dict.fromkeys(("yield_stress", "yield_strength", "hardening", "plasticity"), _PLASTIC)
    | dict.fromkeys(("fibre", "fiber", "orthotropic", "anisotropic", "youngs_modulus_2"), _ISOTROPIC)
    | dict.fromkeys(("width", "plane_stress", "plane_strain", "axisymmetric", "dimension"), _PLANE)
    | dict.fromkeys(("pressure", "inflation"), _PRESSURE)
    | dict.fromkeys(("thickness",), _THICKNESS)
    | dict.fromkeys(("cycles", "fatigue"), _CYCLES)
)
#: What is said of kinds of these names.
KINDS = (
    dict.fromkeys(
        ("viscoelastic", "maxwell", "kelvin-voigt", "zener", "prony", "generalized-maxwell"), _VISCOUS
    )
    | dict.fromkeys(("plastic", "elastoplastic", "von-mises"), _PLASTIC)
    | dict.fromkeys(("orthotropic", "anisotropic", "transversely-isotropic"), _ISOTROPIC)
    | dict.fromkeys(("friction", "coulomb"), _FRICTION)
    | dict.fromkeys(("sphere", "half-sphere", "ball", "cone"), _SPHERE)
    | dict.fromkeys(("pressure", "inflation", "blister"), _PRESSURE)
    | dict.fromkeys(("velocity", "speed", "rate"), _RATE)
)
