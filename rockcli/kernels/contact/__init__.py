"""Full planar contact of one body: rest, slide, rock, slide-rock, flight (docs/contact.md)."""
