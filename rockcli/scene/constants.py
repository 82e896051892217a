"""Conventions and defaults of the models that every solver shares."""

from __future__ import annotations

STANDARD_G = 9.81
"""Acceleration of gravity where a study gives none [m/s²]."""

FREE_ROCKING = 20.0
"""The report goes on this many 1/p after the motion's end, unless the study gives a duration."""

REARM = 1e-3
"""An impact counts, and eta acts, once |theta| has been beyond this fraction of alpha."""

GREENHILL = 7.8373474
"""Weight x L^2/(E I) at which a clamped prismatic column buckles under itself."""

RIGID = 1e-9
"""Rotation by which its own moment m g b bends a column that stands for a rigid one [rad]: far below any yield
rotation that does good."""

ELEMENTS = 5
"""Elements along a column, and of model 4, where the study gives none."""

FIBRES = 21
"""Fibres of a discrete base where the study gives no number."""

DENSITY = 2500.0
"""Density where neither mass nor column is given [kg/m³], per unit depth: it matters to a Winkler base only."""

YIELD_ROTATION = 1e-6
"""Rotation at which a base spring opens [rad]: smaller buys nothing at the default step (docs/frame.md)."""

ALPHA_D = 0.7
"""Parameter of the HHT integrator where the study gives none."""

METHODS = (None, "corotational", "linear")
"""`method` of those backends: the transformation of the elements."""

COARSER = 2.0
"""Their error estimate is the difference to a run with this many times the time step and the yield rotation."""
