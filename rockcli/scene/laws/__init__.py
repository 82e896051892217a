"""What moves a body and what it loses: models, damping, energy, contact, static curves, closed forms of overturning."""
