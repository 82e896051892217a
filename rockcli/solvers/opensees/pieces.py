"""The OpenSeesPy script in pieces of plain text; `script.py` picks those of a case and puts its numbers before them.

The pieces share the names of the parameters.  theta is positive clockwise, to the right: OpenSees' rotation is -theta.
"""

from __future__ import annotations

IMPORTS = """\
import json
import math
import os
import sys

import openseespy.opensees as ops

os.chdir(os.path.dirname(os.path.abspath(__file__)))
"""

BEGIN = """\
# ---------------------------------------------------------------- model
ops.wipe()
ops.logFile(LOG, "-noEcho")  # OpenSees' own messages
ops.model("basic", "-ndm", 2, "-ndf", 3)
"""

COLUMN_OF_MODEL = {
    "1": """\
# Model 1: the mass at height R, and the rotary inertia that makes I_O about the base.
heights = [0.0, R]  # of the nodes of the column [m]
masses = [0.0, m]  # [kg]
rotary = [0.0, I_O - m * R**2]  # [kg m2]
weights = [0.0, m]
drive = math.cos(alpha)  # the ground pulls m a_g R cos(alpha): the motion is scaled, since the node is at R, not h
""",
    "2": """\
# Model 2: all the inertia is rotary; the node at height h carries the weight but no mass.
heights = [0.0, h]  # of the nodes of the column [m]
masses = [0.0, 0.0]  # [kg]
rotary = [0.0, I_O]  # [kg m2]
weights = [0.0, m]
drive = -m * R * math.cos(alpha) / I_O  # a_g as a rotational acceleration, counter-clockwise: hence the sign
""",
    "3": """\
# Model 3: the mass at the height h of the centre of mass, and the rotary inertia that makes I_O about the base.
heights = [0.0, h]  # of the nodes of the column [m]
masses = [0.0, m]  # [kg]
rotary = [0.0, I_O - m * h**2]  # [kg m2]
weights = [0.0, m]
drive = 1.0
""",
    "4": """\
# Model 4: the mass spread along 2R in n elements; the motion is scaled, since the centre of mass is at R, not h.
L = 2.0 * R  # length of the column [m]
drive = math.cos(alpha)
""",
    "flexible": """\
# Flexible column: the mass spread along 2h in n elements.
L = 2.0 * h  # length of the column [m]
drive = 1.0
""",
    "4 on fibres": """\
# Model 4 on fibres: the mass spread along 2h, since the fibres bring the width of the base.
L = 2.0 * h  # length of the column [m]
drive = 1.0
""",
}

SPREAD = """\
heights = [L * i / n for i in range(n + 1)]  # of the nodes of the column [m]
shares = [0.5 if i in (0, n) else 1.0 for i in range(n + 1)]
weights = [m / n * share for share in shares]
"""

LUMPED = """\
# Half masses at the ends.  Five elements make I_O about the base 2 % too large, ten 0.5 %.
masses = weights
"""

CONSISTENT = """\
# Consistent masses are in the elements, not in the nodes.
masses = [0.0] * (n + 1)
"""

LACKING = """\
rotary = [(I_O - m * L**2 / 3.0{moved}) / n * share for share in shares]  # what a line of mass lacks [kg m2]
"""

MOVED = " - m * b**2"

NODES = """\
GROUND, BASE, TOP = 1, 2, len(heights) + 1
ops.node(GROUND, 0.0, 0.0)
ops.fix(GROUND, 1, 1, 1)
for i, height in enumerate(heights):
    ops.node(BASE + i, 0.0, height)
    ops.mass(BASE + i, masses[i], masses[i], rotary[i])
"""

HINGED = """\
ops.fix(BASE, 1, 1, 0)  # the base turns, but neither slides nor lifts off
"""

ON_FIBRES = """\
ops.fix(BASE, 1, 0, 0)  # the base turns and moves vertically on the fibres, but does not slide
"""

ELEMENTS = """\
ops.geomTransf(TRANSFORMATION, 1)
for i in range(len(heights) - 1):
    ops.element("elasticBeamColumn", i + 1, BASE + i, BASE + i + 1, A, E, I, 1{mass}{damping})
"""

ELEMENT_MASS = ', "-mass", m / L, "-cMass"'

ELEMENT_DAMPING = ', "-damp", 1'

SPRING_OF_LAW = {
    "softening": """\
# Base spring: rigid up to M = m g R sin(alpha), then M = m g R sin(alpha - theta), elastic: it closes as it opened.
# The softening contains the weight, so no gravity is applied.
turned = [theta_y] + [0.5 * math.pi * (i / 600) ** 2 for i in range(1, 1201)]
turned = [theta_y] + [q for q in turned if q > 2.0 * theta_y]
moments = [m * g * R * math.sin(alpha - q) for q in turned]
""",
    "plastic": """\
# Base spring: rigid up to M = m g b, then constant, elastic: it closes as it opened.  The weight comes by P-Delta.
turned = [theta_y, 1.0, 4.0]
moments = [m * g * b] * 3
""",
    "winkler": """\
# Base spring: a no-tension elastic base of stiffness kw under the width 2b, the weight on it, vertical inertia
# neglected.  Full contact up to theta_y = m g/(2 kw b^2), then M = m g [b - sqrt(2 m g/(kw theta))/3].
turned = [theta_y * 1.02**i for i in range(2000) if theta_y * 1.02**i < 4.0]
moments = [m * g * (b - math.sqrt(2.0 * m * g / (kw * q)) / 3.0) for q in turned]
""",
}

SPRING = """\
strains = [-q for q in reversed(turned)] + [0.0] + turned
stresses = [-M for M in reversed(moments)] + [0.0] + moments
ops.uniaxialMaterial("ElasticMultiLinear", 1, "-strain", *strains, "-stress", *stresses)
SPRING = 1001
ops.element("zeroLength", SPRING, GROUND, BASE, "-mat", 1, "-dir", 6)


def base_moment():
    \"\"\"Moment of the base on the body, opposing theta [N m].\"\"\"
    return -ops.eleResponse(SPRING, "material", 1, "stress")[0]


def opened():
    \"\"\"Whether the base has opened.\"\"\"
    return abs(theta) > theta_y
"""

FIBRES = """\
# Fibres that carry no tension, from corner to corner: the two at the corners are half as stiff.
ops.uniaxialMaterial("ENT", 1, kw)
ops.section("Fiber", 1)
places = [b * (2.0 * i / (fibres - 1) - 1.0) for i in range(fibres)]
widths = [(0.5 if i in (0, fibres - 1) else 1.0) * 2.0 * b / (fibres - 1) for i in range(fibres)]
for place, width in zip(places, widths):
    ops.fiber(place, 0.0, width, 1)
SECTION = 1001
ops.element("zeroLengthSection", SECTION, GROUND, BASE, 1, "-orient", 0, 1, 0, -1, 0, 0)


def base_moment():
    \"\"\"Moment of the base on the body, opposing theta [N m].\"\"\"
    return -ops.eleResponse(SECTION, "section", "force")[1]


def opened():
    \"\"\"Whether a corner has left the base, which moves up and down.\"\"\"
    return ops.nodeDisp(BASE, 2) + b * abs(theta) > TOLERANCE
"""

DASHPOT = """\
# Rotational damper at the base.
ops.uniaxialMaterial("Viscous", 2, c, 1.0)
ops.element("zeroLength", 1002, GROUND, BASE, "-mat", 2, "-dir", 6)
"""

GRAVITY = """\
# ---------------------------------------------------------------- weight
ops.timeSeries("Linear", 1)
ops.pattern("Plain", 1, 1)
for i, weight in enumerate(weights):
    ops.load(BASE + i, 0.0, -weight * g, 0.0)


def settle(steps):
    \"\"\"Bring the body into equilibrium under its weight, put on in so many steps.\"\"\"
    ops.constraints("Plain")
    ops.numberer("RCM")
    ops.system("BandGeneral")
    ops.test("NormDispIncr", 1e-10, 50)
    ops.algorithm("Newton")
    ops.integrator("LoadControl", 1.0 / steps)
    ops.analysis("Static")
    if ops.analyze(steps) != 0:
        sys.exit("no equilibrium under its own weight: the column buckles or the base is too soft")
    ops.loadConst("-time", 0.0)
    ops.wipeAnalysis()


settle(10)
"""

HELD = """\
ops.fix(BASE, 0, 0, 1)  # the column bends under its turned weight, the base held as it is turned
settle(1)
ops.remove("sp", BASE, 3)
"""

UNIFORM = """\
# ---------------------------------------------------------------- ground motion
ops.timeSeries("Path", 2, "-dt", DT_MOTION, "-filePath", MOTION, "-factor", drive)
ops.pattern("UniformExcitation", 2, DIRECTION, "-accel", 2)
"""

UNIFORM_FROM_NODES = """\
# Masses are nodal: OpenSees 3.7 counts those of elements (-mass) twice in a uniform excitation.
"""

NODAL_PULL = """\
# ---------------------------------------------------------------- ground motion
# -m a_g as nodal forces: OpenSees 3.7 counts the masses of elements twice in a uniform excitation.
ops.timeSeries("Path", 2, "-dt", DT_MOTION, "-filePath", MOTION, "-factor", -drive)
ops.pattern("Plain", 2, 2)
for i, weight in enumerate(weights):
    end = {0: -1.0, n: 1.0}.get(i, 0.0) * m / L * (L / n) ** 2 / 12.0
    ops.load(BASE + i, weight, 0.0, end)
"""

VERTICAL = """\
ops.timeSeries("Path", 3, "-dt", DT_VERTICAL, "-filePath", VERTICAL)
ops.pattern("UniformExcitation", 3, 2, "-accel", 3)
"""

VERTICAL_PULL = """\
ops.timeSeries("Path", 3, "-dt", DT_VERTICAL, "-filePath", VERTICAL, "-factor", -1.0)
ops.pattern("Plain", 3, 3)
for i, weight in enumerate(weights):
    ops.load(BASE + i, 0.0, weight, 0.0)
"""

STIFFNESS_DAMPING = """\
# Stiffness-proportional damping, zeta at the first mode of the clamped column, of the forces within the elements.
# Rayleigh damping (ops.rayleigh) has the axial force in its stiffness: under weight it would drive the rocking.
# It begins with the second step: in the first OpenSees 3.7 takes what the weight put into the elements for a rate.
omega_1 = 1.8751041**2 * math.sqrt(E * I / (m / L * L**4))
ops.damping("SecStif", 1, 2.0 * zeta / omega_1{integrator}, "-activateTime", 1.5 * DT)
"""

INITIAL = """\
# ---------------------------------------------------------------- initial state: turned rigidly about the base
{rise}sin, cos = math.sin(theta_0), math.cos(theta_0)
for i, height in enumerate(heights):
    moved = [{moved}, -theta_0]
    moving = [{moving}, -theta_dot_0]
    for dof in (1, 2, 3):
        ops.setNodeDisp(BASE + i, dof, ops.nodeDisp(BASE + i, dof) + moved[dof - 1], "-commit")
        ops.setNodeVel(BASE + i, dof, moving[dof - 1], "-commit")
"""

RISE = """\
low, high = -m * g / (2.0 * kw * b) - b * abs(theta_0), b * abs(theta_0)  # the base, too deep and clear of the fibres
for _ in range(200):
    rise = 0.5 * (low + high)  # where the fibres carry the weight
    carried = sum(kw * width * max(0.0, -rise - place * theta_0) for place, width in zip(places, widths))
    low, high = (rise, high) if carried > m * g else (low, rise)
rise -= ops.nodeDisp(BASE, 2)
"""

INITIAL_TURNED = ("height * sin, -height * (1.0 - cos)", "height * cos * theta_dot_0, -height * sin * theta_dot_0")
INITIAL_LINEAR = ("height * theta_0, 0.0", "height * theta_dot_0, 0.0")
INITIAL_LIFTED = (
    "height * sin, rise - height * (1.0 - cos)",
    "height * cos * theta_dot_0, (math.copysign(b * cos, theta_0) - height * sin) * theta_dot_0",
)

ANALYSIS = """\
# ---------------------------------------------------------------- analysis
ops.constraints("Plain")
ops.numberer("RCM")
ops.system("BandGeneral")
ops.test("NormDispIncr", TOLERANCE, 20)  # on displacements: with a stiff column the unbalance is all round-off
ops.algorithm("Newton")
{integrator}
ops.analysis("Transient")
ops.domainChange()
"""

NEWMARK = 'ops.integrator("Newmark", 0.5, 0.25)  # average acceleration: no damping of its own'
HHT = 'ops.integrator("HHT", alpha_d)  # OpenSees\' parameter: 2/3 damps most, 1 not at all'
